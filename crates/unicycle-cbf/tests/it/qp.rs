//! Optima of quadratic programs: their conditions and degenerate rows; `clarabel.rs` has an independent judge.

mod clarabel;
mod programs;

use std::array::from_fn;

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use unicycle_cbf::qp::{MAX_ROWS, Row, Solution, Status, VARIABLES, solve};

use crate::shared::shared;

use clarabel::Worst;
use programs::{FAMILIES, Program, Vector, norm, program};

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
        Worst::default().check(&program);
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
    let Some(file) = shared("vectors/control.json") else {
        return;
    };
    let text = std::fs::read_to_string(file).unwrap();
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
