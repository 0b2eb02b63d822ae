//! Optima of quadratic programs: their conditions, degenerate rows, and the interior point method of Clarabel as a judge.

use std::array::from_fn;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus,
};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use unicycle_cbf::qp::{MAX_ROWS, Row, Solution, Status, VARIABLES, solve};

type Vector = [f64; VARIABLES];

fn dot(a: &Vector, b: &Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &Vector) -> f64 {
    dot(a, a).sqrt()
}

/// A program with its rows brought to unit normals in `y = W^(1/2) z`, independently of the solver.
#[derive(Debug, Clone)]
struct Program {
    weights: Vector,
    rows: Vec<Row>,
}

/// What a solution looks like in `y`.
struct Scaled {
    y: Vector,
    rows: Vec<Row>,
    multipliers: Vec<f64>,
}

impl Program {
    fn length(&self, row: &Row) -> f64 {
        let length = norm(&from_fn(|i| row.a[i] / self.weights[i].sqrt()));
        if length > 0.0 { length } else { 1.0 }
    }

    fn scaled(&self, solution: &Solution) -> Scaled {
        let lengths = self.rows.iter().map(|row| self.length(row));
        let scaled = |row: &Row| Row {
            a: from_fn(|i| row.a[i] / self.weights[i].sqrt() / self.length(row)),
            b: row.b / self.length(row),
        };
        Scaled {
            y: from_fn(|i| solution.z[i] * self.weights[i].sqrt()),
            rows: self.rows.iter().map(scaled).collect(),
            multipliers: (solution.multipliers.iter().zip(lengths))
                .map(|(multiplier, length)| 0.5 * multiplier * length)
                .collect(),
        }
    }
}

impl Scaled {
    fn largest_offset(&self) -> f64 {
        self.rows
            .iter()
            .fold(0.0, |most, row| most.max(row.b.abs()))
    }

    fn largest_multiplier(&self) -> f64 {
        self.multipliers.iter().fold(0.0, |most, l| most.max(*l))
    }

    /// Unit of distances: that of the optimum from the origin, else of the nearest row.
    fn unit(&self) -> f64 {
        let offsets = self.rows.iter().map(|row| row.b.abs());
        let nearest = offsets.filter(|b| *b > 0.0).fold(f64::INFINITY, f64::min);
        match norm(&self.y) {
            length if length > 0.0 => length,
            _ if nearest.is_finite() => nearest,
            _ => 1.0,
        }
    }

    /// Residual of the conditions of an optimum, relative.
    fn residual(&self) -> f64 {
        let length = norm(&self.y);
        let size = length.max(self.largest_multiplier()).max(f64::MIN_POSITIVE);
        let (mut gradient, mut worst) = (self.y, 0.0_f64);
        for (row, multiplier) in self.rows.iter().zip(&self.multipliers) {
            let reach = length + row.b.abs();
            let excess = dot(&row.a, &self.y) - row.b;
            if reach > 0.0 && norm(&row.a) > 0.0 {
                worst = worst.max(excess / reach);
                worst = worst.max(multiplier / size * excess.abs() / reach);
            }
            worst = worst.max(-multiplier / size);
            gradient = from_fn(|i| gradient[i] + multiplier * row.a[i]);
        }
        worst.max(norm(&gradient) / size)
    }

    /// Every row is either clearly active or clearly not: interior points then converge sharply.
    fn is_strict(&self) -> bool {
        let least = 1e-4 * self.unit();
        let clear = |(row, multiplier): (&Row, &f64)| {
            *multiplier > least || row.b - dot(&row.a, &self.y) > least
        };
        self.rows.iter().zip(&self.multipliers).all(clear)
    }

    /// How much a change of the right sides changes the objective.
    fn sensitivity(&self) -> f64 {
        self.largest_multiplier() / norm(&self.y).max(f64::MIN_POSITIVE)
    }

    /// For a proof that rows contradict each other, relative to the sum of its multipliers: how far the normals are from adding up to
    /// zero, and by how much the rows miss each other.
    fn proof(&self) -> (f64, f64) {
        let sum: f64 = self.multipliers.iter().sum();
        let (mut normal, mut offset) = ([0.0; VARIABLES], 0.0);
        for (row, multiplier) in self.rows.iter().zip(&self.multipliers) {
            normal = from_fn(|i| normal[i] + multiplier * row.a[i]);
            offset += multiplier * row.b;
        }
        (norm(&normal) / sum, -offset / sum)
    }
}

const FAMILIES: u32 = 6;

/// Random programs: dense, badly scaled and feasible, small integers, badly scaled, multiples of other rows, and rows like those of
/// the controller.
fn program(random: &mut ChaCha8Rng, family: u32) -> Program {
    let normal = |random: &mut ChaCha8Rng| -> f64 {
        (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
    };
    let spread = |random: &mut ChaCha8Rng, low: f64, high: f64| -> f64 {
        let size = 10_f64.powf(low + (high - low) * random.random::<f64>());
        if random.random::<bool>() { size } else { -size }
    };
    let count = random.random_range(0..=MAX_ROWS);
    let (low, high) = match family {
        0 | 2 => (0.0, 0.0),
        4 | 5 => (-3.0, 6.0),
        _ => (-6.0, 9.0),
    };
    let weights: Vector = from_fn(|_| spread(random, low, high).abs());
    let inside: Vector = from_fn(|i| normal(random) / weights[i].sqrt());
    let mut rows: Vec<Row> = Vec::new();
    while rows.len() < count {
        let mut row = Row {
            a: from_fn(|_| normal(random)),
            b: normal(random) + 0.5,
        };
        match family {
            0 => {}
            1 | 3 => {
                let full = random.random::<f64>();
                row.a = from_fn(|_| {
                    let size = spread(random, -6.0, 5.0);
                    if random.random::<f64>() < full {
                        size
                    } else {
                        0.0
                    }
                });
                let length = norm(&from_fn(|i| row.a[i] / weights[i].sqrt()));
                row.b = if family == 1 {
                    dot(&row.a, &inside) + normal(random).abs() * length
                } else {
                    length * row.b
                };
            }
            2 => {
                row.a = from_fn(|_| f64::from(random.random_range(-2..=2)));
                row.b = f64::from(random.random_range(-1..=3));
            }
            4 if rows.len() > 1 && random.random() => {
                let (first, second) = (
                    rows[random.random_range(0..rows.len())],
                    rows[random.random_range(0..rows.len())],
                );
                let factor = spread(random, -3.0, 3.0);
                let share = [0.0, normal(random)][random.random_range(0..2)];
                let room = [0.0, normal(random).abs()][random.random_range(0..2)];
                row.a = from_fn(|i| factor * (first.a[i] + share * second.a[i]));
                row.b = factor * (first.b + share * second.b) + room * factor.abs();
            }
            4 => {}
            _ => {
                let slack = 2 + rows.len();
                row.a = from_fn(|i| match i {
                    0 => spread(random, -2.0, 2.0),
                    1 => spread(random, 0.0, 5.0),
                    _ if i == slack => -1.0,
                    _ => 0.0,
                });
                row.b = spread(random, -4.0, 0.0);
                if slack >= VARIABLES {
                    row.b = row.b.abs();
                }
            }
        }
        rows.push(row);
    }
    Program { weights, rows }
}

/// `y` of the optimum in the unit of the program, and how sure it is.
fn by_clarabel(scaled: &Scaled) -> (SolverStatus, Vector) {
    let count = scaled.rows.len();
    let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
    for i in 0..VARIABLES {
        for (j, row) in scaled.rows.iter().enumerate() {
            if row.a[i] != 0.0 {
                places.push(j);
                values.push(row.a[i]);
            }
        }
        starts.push(places.len());
    }
    let hessian = CscMatrix::identity(VARIABLES);
    let rows = CscMatrix::new(count, VARIABLES, starts, places, values);
    let right: Vec<f64> = scaled
        .rows
        .iter()
        .map(|row| row.b / scaled.unit())
        .collect();
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-12)
        .tol_gap_rel(1e-12)
        .tol_feas(1e-12)
        .build()
        .unwrap();
    let cones = [NonnegativeConeT(count)];
    let mut solver =
        DefaultSolver::new(&hessian, &[0.0; VARIABLES], &rows, &right, &cones, settings).unwrap();
    solver.solve();
    (solver.solution.status, from_fn(|i| solver.solution.x[i]))
}

/// Worst figures over many programs.
#[derive(Debug, Default)]
struct Worst {
    residual: f64,
    own_residual: f64,
    optimal: u32,
    infeasible: u32,
    iterations: u32,
    compared: u32,
    strict: u32,
    strict_distance: f64,
    distance: f64,
    near_border: u32,
    unsure: u32,
}

impl Worst {
    fn check(&mut self, program: &Program, judged: bool) {
        let solution = solve(&program.weights, &program.rows);
        let scaled = program.scaled(&solution);
        self.iterations = self.iterations.max(solution.iterations);
        match solution.status {
            Status::Optimal => {
                self.optimal += 1;
                let own = solution.kkt_residual(&program.weights, &program.rows);
                self.own_residual = self.own_residual.max(own);
                self.residual = self.residual.max(scaled.residual());
                assert!(own <= 1e-9 && scaled.residual() <= 1e-9, "{program:?}");
            }
            Status::Infeasible => {
                self.infeasible += 1;
                let (normal, gap) = scaled.proof();
                assert!(
                    normal <= 1e-13 && gap > -1e-15,
                    "{normal:e} {gap:e} {program:?}"
                );
            }
            status => panic!("{status:?} for {program:?}"),
        }
        if judged {
            self.judge(program, &solution, &scaled);
        }
    }

    /// The residual proves that rows declared feasible are, multipliers prove that others are not. Clarabel may see a program
    /// differently only close to the border between them, where a relative change of 1e-6 of the right sides crosses it.
    fn judge(&mut self, program: &Program, solution: &Solution, scaled: &Scaled) {
        let (status, y) = by_clarabel(scaled);
        let optimal = solution.status == Status::Optimal;
        let near_border = if optimal {
            scaled.sensitivity() > 1e4 || norm(&scaled.y) > 1e4 * scaled.largest_offset()
        } else {
            scaled.proof().1 < 1e-6 * scaled.largest_offset()
        };
        match status {
            _ if optimal && near_border => self.near_border += 1,
            SolverStatus::Solved if optimal => {
                self.compared += 1;
                let distance = norm(&from_fn(|i| y[i] - scaled.y[i] / scaled.unit()));
                if scaled.is_strict() {
                    self.strict += 1;
                    self.strict_distance = self.strict_distance.max(distance);
                    assert!(distance <= 1e-7, "{distance:e} {program:?}");
                } else {
                    self.distance = self.distance.max(distance);
                    assert!(distance <= 1e-5, "{distance:e} {program:?}");
                }
            }
            SolverStatus::Solved => assert!(near_border, "{program:?}"),
            SolverStatus::PrimalInfeasible => assert!(!optimal, "{program:?}"),
            _ => self.unsure += 1,
        }
    }
}

fn check_many(count: u32, judged_each: u32) {
    let mut random = ChaCha8Rng::seed_from_u64(1983);
    for family in 0..FAMILIES {
        let mut worst = Worst::default();
        for k in 0..count / FAMILIES {
            worst.check(&program(&mut random, family), k % judged_each == 0);
        }
        println!("family {family}: {worst:?}");
    }
}

#[test]
fn a_hundred_thousand_programs_are_solved() {
    check_many(100_002, 20);
}

#[test]
#[ignore = "minutes without optimisation: cargo test --release -- --ignored"]
fn a_hundred_thousand_optima_agree_with_clarabel() {
    check_many(100_002, 1);
}

fn seeded() -> impl Strategy<Value = (Program, u64)> {
    (any::<u64>(), 0..FAMILIES).prop_map(|(seed, family)| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (program(&mut random, family), random.random())
    })
}

/// Sign, digits and power of ten of a number, and some zeros.
fn number(low: i32, high: i32) -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => Just(0.0),
        4 => (-9.99..9.99, low..=high).prop_map(|(digits, power)| digits * 10_f64.powi(power)),
    ]
}

fn badly_scaled() -> impl Strategy<Value = Program> {
    let row = (prop::array::uniform5(number(-6, 4)), number(-6, 4)).prop_map(|(a, b)| Row { a, b });
    let weight =
        (1.0..9.99, -6..9).prop_map(|(digits, power): (f64, _)| digits * 10_f64.powi(power));
    (
        prop::array::uniform5(weight),
        prop::collection::vec(row, 0..=MAX_ROWS),
    )
        .prop_map(|(weights, rows)| Program { weights, rows })
}

/// Two ways to write the same program agree, unless its rows contradict each other by about round-off.
fn same(first: (&Program, &Solution), second: (&Program, &Solution)) -> Result<(), TestCaseError> {
    let (one, other) = (first.0.scaled(first.1), second.0.scaled(second.1));
    if first.1.status != second.1.status {
        let infeasible = if first.1.status == Status::Infeasible {
            &one
        } else {
            &other
        };
        prop_assert!(infeasible.proof().1 <= 1e-9 * infeasible.largest_offset());
    } else if first.1.status == Status::Optimal {
        let size = one.unit().max(one.largest_multiplier());
        let distance = norm(&from_fn(|i| one.y[i] - other.y[i]));
        prop_assert!(distance <= 1e-9 * size, "{distance:e} of {size:e}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2_000) })]

    #[test]
    fn solutions_satisfy_their_conditions(program in badly_scaled()) {
        Worst::default().check(&program, false);
    }

    #[test]
    fn the_order_of_rows_does_not_matter((program, seed) in seeded()) {
        let mut turned = program.clone();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        for last in (1..turned.rows.len()).rev() {
            turned.rows.swap(last, random.random_range(0..=last));
        }
        let first = solve(&program.weights, &program.rows);
        let second = solve(&turned.weights, &turned.rows);
        same((&program, &first), (&turned, &second))?;
    }

    #[test]
    fn the_units_of_rows_do_not_matter((program, seed) in seeded()) {
        let mut changed = program.clone();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        for row in changed.rows.iter_mut().filter(|row| norm(&row.a) > 0.0) {
            let factor = 10_f64.powi(random.random_range(-12..=12));
            *row = Row { a: row.a.map(|a| a * factor), b: row.b * factor };
        }
        let first = solve(&program.weights, &program.rows);
        let second = solve(&changed.weights, &changed.rows);
        same((&program, &first), (&changed, &second))?;
    }

    #[test]
    fn the_unit_of_the_objective_does_not_matter((program, _) in seeded(), power in -6..=6) {
        let factor = 4_f64.powi(power);
        let first = solve(&program.weights, &program.rows);
        let second = solve(&program.weights.map(|w| w * factor), &program.rows);
        prop_assert_eq!(first.z, second.z);
        prop_assert_eq!((first.status, first.active), (second.status, second.active));
    }

    #[test]
    fn repeated_and_empty_rows_do_not_matter((program, seed) in seeded()) {
        let mut more = program.clone();
        more.rows.truncate(MAX_ROWS / 2 - 1);
        let less = more.clone();
        more.rows.extend(less.rows.iter().copied());
        more.rows.push(Row { a: [0.0; VARIABLES], b: (seed % 2) as f64 });
        let first = solve(&less.weights, &less.rows);
        let second = solve(&more.weights, &more.rows);
        same((&less, &first), (&more, &second))?;
    }

    #[test]
    fn any_bits_have_a_status(
        weights in prop::array::uniform5(any::<f64>()),
        rows in prop::collection::vec((prop::array::uniform5(any::<f64>()), any::<f64>()), 0..=MAX_ROWS),
    ) {
        let rows: Vec<Row> = rows.into_iter().map(|(a, b)| Row { a, b }).collect();
        let solution = solve(&weights.map(f64::abs), &rows);
        prop_assert!(solution.z.iter().all(|z| z.is_finite()));
    }
}

const ONES: Vector = [1.0; VARIABLES];

fn row(first: f64, second: f64, b: f64) -> Row {
    Row {
        a: [first, second, 0.0, 0.0, 0.0],
        b,
    }
}

#[test]
fn opposite_rows_make_an_equality() {
    let rows = [row(1.0, 1.0, 2.0), row(-3.0, -3.0, -6.0)];
    let solution = solve(&ONES, &rows);
    assert_eq!(solution.status, Status::Optimal);
    assert!((solution.z[0] - 1.0).abs() <= 1e-15 && (solution.z[1] - 1.0).abs() <= 1e-15);
    // 0.1 and 0.3 are rounded, the rows contradict each other by that
    let rows = [
        row(0.1, 0.0, 0.3),
        row(-1.0, 0.0, -3.0),
        row(-0.7, 0.0, -2.1),
    ];
    assert_eq!(solve(&ONES, &rows).status, Status::Optimal);
}

#[test]
fn contradicting_rows_are_infeasible() {
    for gap in [1e-9, 1e-3, 1.0, 1e9] {
        let rows = [
            row(1e5, 0.0, 1e5),
            row(0.0, 1.0, -2.0),
            row(-1e-6, 0.0, -1e-6 * (1.0 + gap)),
        ];
        let solution = solve(&ONES, &rows);
        assert_eq!(solution.status, Status::Infeasible, "{gap}");
        assert_eq!(solution.z, [0.0; VARIABLES]);
        assert!(solution.multipliers[0] > 0.0 && solution.multipliers[2] > 0.0);
    }
}

#[test]
fn rows_without_a_normal_hold_or_do_not() {
    let with = |b: f64| solve(&ONES, &[row(-1.0, 0.0, -1.0), row(0.0, 0.0, b)]);
    for b in [1.0, 0.0, -0.0, -1e-13] {
        assert_eq!((with(b).status, with(b).z[0]), (Status::Optimal, 1.0));
    }
    for b in [-1e-11, -1.0] {
        assert_eq!(
            (with(b).status, with(b).multipliers[1]),
            (Status::Infeasible, 1.0)
        );
    }
}

#[test]
fn a_corner_with_more_rows_than_variables() {
    let mut rows: Vec<Row> = (0..VARIABLES)
        .map(|i| Row {
            a: from_fn(|k| if k == i { -1.0 } else { 0.0 }),
            b: -1.0,
        })
        .collect();
    for i in 0..VARIABLES {
        rows.push(Row {
            a: from_fn(|k| if k == i { -2.0 } else { -1.0 }),
            b: -6.0,
        });
    }
    let solution = solve(&ONES, &rows);
    assert_eq!(solution.status, Status::Optimal);
    assert!(solution.z.iter().all(|z| (z - 1.0).abs() <= 1e-14));
    assert!(solution.kkt_residual(&ONES, &rows) <= 1e-14);
}

#[test]
fn refused_input_has_its_own_status() {
    assert_eq!(solve(&ONES, &[]).status, Status::Optimal);
    assert_eq!(
        solve(&ONES, &[row(1.0, 0.0, 1.0); MAX_ROWS]).status,
        Status::Optimal
    );
    assert_eq!(
        solve(&ONES, &[row(1.0, 0.0, 1.0); MAX_ROWS + 1]).status,
        Status::TooManyRows
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for rows in [row(bad, 0.0, 1.0), row(1.0, 0.0, bad), row(0.0, 0.0, bad)] {
            assert_eq!(
                solve(&ONES, &[row(1.0, 1.0, 1.0), rows]).status,
                Status::NotFinite
            );
        }
        assert_eq!(
            solve(&[bad, 1.0, 1.0, 1.0, 1.0], &[]).status,
            Status::NotFinite
        );
    }
    for bad in [0.0, -1.0] {
        assert_eq!(
            solve(&[bad, 1.0, 1.0, 1.0, 1.0], &[]).status,
            Status::NotFinite
        );
    }
}

#[test]
fn a_shared_slack_takes_up_a_contradiction() {
    let weights = [1.0, 1.0, 1.0, 1.0, 1.0, 1e9];
    let soft = |a: f64, b: f64| Row {
        a: [a, 0.0, 0.0, 0.0, 0.0, -1.0],
        b,
    };
    let rows = [soft(1.0, -1.0), soft(-1.0, -1.0)];
    let solution = solve(&weights, &rows);
    assert_eq!(solution.status, Status::Optimal);
    assert!(solution.z[0].abs() <= 1e-9 && (solution.z[5] - 1.0).abs() <= 1e-12);
    assert!(solution.kkt_residual(&weights, &rows) <= 1e-12);
}

#[test]
fn optima_of_the_controller_agree() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../../shared/vectors/control.json"
    );
    let Ok(text) = std::fs::read_to_string(file) else {
        return;
    };
    let document: Value = serde_json::from_str(&text).unwrap();
    let numbers = |value: &Value| -> Vec<f64> {
        value
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect()
    };
    let vector = |value: &Value| -> Vector { numbers(value).try_into().unwrap() };
    for case in document["cases"].as_array().unwrap() {
        let weights = vector(&case["H"]);
        let normals = case["A"].as_array().unwrap().iter();
        let rows: Vec<Row> = (normals.zip(numbers(&case["b"])))
            .map(|(a, b)| Row { a: vector(a), b })
            .collect();
        let solution = solve(&weights, &rows);
        let feasible = case["feasible"].as_bool().unwrap();
        assert_eq!(solution.status == Status::Optimal, feasible);
        assert!(solution.kkt_residual(&weights, &rows) <= 1e-14);
        let expected = vector(&case["u_opt"]);
        let expected: Vector = from_fn(|i| expected[i] * weights[i].sqrt());
        let found: Vector = from_fn(|i| solution.z[i] * weights[i].sqrt());
        let distance = norm(&from_fn(|i| found[i] - expected[i]));
        assert!(distance <= 1e-7 * norm(&expected), "{distance:e}");
    }
}
