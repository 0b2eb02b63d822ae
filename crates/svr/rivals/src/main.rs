//! The task of the benchmarks, fitted by this project and by the crate `linfa-svm`: one JSON line per fit.
//!
//! Both objectives of every fit are evaluated here, in double precision, from its coefficients `β` and its `b`; what the
//! program says of itself is beside them. One fit per process makes the peak of the memory its own.

mod objectives;
#[path = "../../benches/task/mod.rs"]
mod task;

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;

use linfa::Dataset;
use linfa::traits::{Fit as _, Predict as _};
use linfa_svm::Svm;
use ndarray::{Array1, Array2, ArrayView2};
use serde_json::json;
use svr::{Kernel, Penalty, Response, Samples, Settings, UsedPenalty};

use objectives::{Solution, evaluate};
use task::{PREDICTORS, Task};

const USAGE: &str = "rivals --samples N [--program svr|linfa] [--kernel linear|rbf|quadratic] [--export FOLDER]

    --program   only this one; without, both
    --kernel    only this one; without, all three
    --export    nothing is fitted: the standardised predictors, the response and the samples to predict go into the folder,
                as little-endian doubles, row by row, with a header task.json";

/// How many samples are predicted.
const PROBE: usize = 16_000;
/// linfa-svm keeps the kernel matrix in double precision.
const LINFA_UP_TO: usize = 8_000;
const TOLERANCE: f64 = 1e-3;

/// Fits that take less than this are repeated, and the fastest counts.
const REPEAT_BELOW_S: f64 = 60.0;
const REPETITIONS: usize = 3;

struct Arguments {
    samples: usize,
    programs: Vec<String>,
    kernels: Vec<Kernel>,
    export: Option<String>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = parse()?;
    if let Some(folder) = &arguments.export {
        return export(Path::new(folder), arguments.samples);
    }
    for program in &arguments.programs {
        for &kernel in &arguments.kernels {
            match program.as_str() {
                "svr" => fit_ours(kernel, arguments.samples)?,
                _ if arguments.samples > LINFA_UP_TO => {}
                _ => fit_linfa(kernel, arguments.samples)?,
            }
        }
    }
    Ok(())
}

fn parse() -> Result<Arguments, String> {
    let mut parsed = Arguments {
        samples: 0,
        programs: vec!["svr".to_owned(), "linfa".to_owned()],
        kernels: vec![Kernel::Linear, Kernel::Rbf, Kernel::Quadratic],
        export: None,
    };
    let mut words = std::env::args().skip(1);
    while let Some(flag) = words.next() {
        let value = words.next().ok_or(USAGE)?;
        match (flag.as_str(), value.as_str()) {
            ("--samples", n) => parsed.samples = n.parse().map_err(|_| USAGE)?,
            ("--program", "svr" | "linfa") => parsed.programs = vec![value],
            ("--kernel", "linear") => parsed.kernels = vec![Kernel::Linear],
            ("--kernel", "rbf") => parsed.kernels = vec![Kernel::Rbf],
            ("--kernel", "quadratic") => parsed.kernels = vec![Kernel::Quadratic],
            ("--export", _) => parsed.export = Some(value),
            _ => return Err(USAGE.to_owned()),
        }
    }
    if parsed.samples == 0 {
        return Err(USAGE.to_owned());
    }
    Ok(parsed)
}

/// Mean 0 and standard deviation 1 over the samples of the fit, as svr does it.
struct Standardised {
    columns: Vec<(f64, f64)>,
    predictors: Array2<f64>,
}

impl Standardised {
    fn new(task: &Task) -> Self {
        let raw = matrix(task);
        let columns = raw.columns();
        let columns: Vec<_> = columns
            .into_iter()
            .map(|column| {
                let mean = column.mean().unwrap_or(0.0);
                let deviation = column.std(1.0);
                let most = column.fold(0.0_f64, |most, x| most.max(x.abs()));
                let varies = deviation > 1e-12 * most;
                (mean, if varies { 1.0 / deviation } else { 0.0 })
            })
            .collect();
        let predictors = scale(&raw, &columns);
        Self {
            columns,
            predictors,
        }
    }

    fn apply(&self, task: &Task) -> Array2<f64> {
        scale(&matrix(task), &self.columns)
    }
}

fn matrix(task: &Task) -> ArrayView2<'_, f64> {
    let shape = (task.response.len(), PREDICTORS);
    ArrayView2::from_shape(shape, &task.predictors).expect("one row per response")
}

fn scale(raw: &ArrayView2<'_, f64>, columns: &[(f64, f64)]) -> Array2<f64> {
    Array2::from_shape_fn(raw.dim(), |(i, k)| {
        (raw[(i, k)] - columns[k].0) * columns[k].1
    })
}

fn penalty(task: &Task) -> Result<UsedPenalty, svr::Error> {
    Penalty::default().resolve(&task.response)
}

fn fit_ours(kernel: Kernel, n: usize) -> Result<(), Box<dyn std::error::Error>> {
    let task = Task::load(n);
    let samples = Samples::new(&task.predictors, PREDICTORS)?;
    let response = Response::new(&task.response)?;
    let settings = Settings {
        kernel,
        ..Settings::default()
    };
    let before_mb = peak_memory_mb();
    let (fit, seconds) = timed(|| svr::fit(&samples, &response, &settings, &Penalty::default()))?;
    let peak_mb = peak_memory_mb();
    let probe = Task::load(PROBE);
    let start = Instant::now();
    let predicted = fit
        .model
        .predict(&Samples::new(&probe.predictors, PREDICTORS)?)?;
    let predict_seconds = start.elapsed().as_secs_f64();
    assert_eq!(predicted.len(), PROBE);
    let scaled = Standardised::new(&task).predictors / fit.model.kernel_scale();
    let objectives = evaluate(&Solution {
        kernel,
        scaled: &scaled,
        response: &task.response,
        penalty: fit.penalty,
        beta: &fit.beta,
        bias: fit.model.bias(),
    });
    let line = json!({
        "program": "svr",
        "kernel": kernel,
        "samples": n,
        "seconds": seconds.fastest,
        "first_seconds": seconds.first,
        "primal": objectives.primal,
        "dual": objectives.dual,
        "infeasibility": objectives.infeasibility,
        "own_primal": fit.primal_objective,
        "own_dual": fit.dual_objective,
        "support_vectors": fit.support_vectors,
        "status": fit.status,
        "before_mb": before_mb,
        "peak_mb": peak_mb,
        "predict_samples": PROBE,
        "predict_seconds": predict_seconds,
    });
    println!("{line}");
    Ok(())
}

/// `gaussian_kernel(e)` is `exp(−‖x − z‖²/e)` and `polynomial_kernel(c, q)` is `(x·z + c)^q`: predictors divided by the scale
/// make them ours. Its solver is LIBSVM's, here with the same tolerance; its default is not to shrink.
fn fit_linfa(kernel: Kernel, n: usize) -> Result<(), Box<dyn std::error::Error>> {
    let task = Task::load(n);
    let used = penalty(&task)?;
    let kernel_scale = kernel.default_scale(PREDICTORS);
    let standardised = Standardised::new(&task);
    let dataset = Dataset::new(
        &standardised.predictors / kernel_scale,
        Array1::from_vec(task.response.clone()),
    );
    let parameters = Svm::<f64, f64>::params()
        .c_svr(used.box_constraint, Some(used.tube_epsilon))
        .eps(TOLERANCE);
    let parameters = match kernel {
        Kernel::Linear => parameters.linear_kernel(),
        Kernel::Rbf => parameters.gaussian_kernel(1.0),
        Kernel::Quadratic => parameters.polynomial_kernel(1.0, 2.0),
        Kernel::Cubic => parameters.polynomial_kernel(1.0, 3.0),
    };
    let before_mb = peak_memory_mb();
    let (model, seconds) = timed(|| parameters.fit(&dataset))?;
    let peak_mb = peak_memory_mb();
    let probe = standardised.apply(&Task::load(PROBE)) / kernel_scale;
    let start = Instant::now();
    let predicted: Array1<f64> = model.predict(&probe);
    let predict_seconds = start.elapsed().as_secs_f64();
    assert_eq!(predicted.len(), PROBE);
    let objectives = evaluate(&Solution {
        kernel,
        scaled: &dataset.records,
        response: &task.response,
        penalty: used,
        beta: &model.alpha,
        bias: -model.rho,
    });
    // The reason to end is private, but printed.
    let ended = model.to_string().starts_with("Exited after");
    let line = json!({
        "program": "linfa",
        "kernel": kernel,
        "samples": n,
        "seconds": seconds.fastest,
        "first_seconds": seconds.first,
        "primal": objectives.primal,
        "dual": objectives.dual,
        "infeasibility": objectives.infeasibility,
        "support_vectors": model.nsupport(),
        "status": if ended { "optimal" } else { "iteration-limit" },
        "before_mb": before_mb,
        "peak_mb": peak_mb,
        "predict_samples": PROBE,
        "predict_seconds": predict_seconds,
    });
    println!("{line}");
    Ok(())
}

/// Seconds of a fit in a fresh process, whose memory is still to come from the system, and of the fastest of all.
struct Seconds {
    first: f64,
    fastest: f64,
}

fn timed<T, E>(fit: impl Fn() -> Result<T, E>) -> Result<(T, Seconds), E> {
    let once = || {
        let start = Instant::now();
        let fitted = fit()?;
        Ok((fitted, start.elapsed().as_secs_f64()))
    };
    let (fitted, first) = once()?;
    let mut fastest = first;
    if first < REPEAT_BELOW_S {
        for _ in 1..REPETITIONS {
            fastest = fastest.min(once()?.1);
        }
    }
    Ok((fitted, Seconds { first, fastest }))
}

/// Of this process, as Linux tells it.
fn peak_memory_mb() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = peak.trim().strip_suffix(" kB")?.trim().parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}

fn export(folder: &Path, n: usize) -> Result<(), Box<dyn std::error::Error>> {
    let task = Task::load(n);
    let standardised = Standardised::new(&task);
    let used = penalty(&task)?;
    fs::create_dir_all(folder)?;
    write(
        &folder.join("predictors.f64"),
        standardised.predictors.iter(),
    )?;
    write(&folder.join("response.f64"), task.response.iter())?;
    write(
        &folder.join("probe.f64"),
        standardised.apply(&Task::load(PROBE)).iter(),
    )?;
    let header = json!({
        "samples": n,
        "predictors": PREDICTORS,
        "probe": PROBE,
        "box_constraint": used.box_constraint,
        "tube_epsilon": used.tube_epsilon,
        "tolerance": TOLERANCE,
        "kernel_scale": {
            "linear": Kernel::Linear.default_scale(PREDICTORS),
            "rbf": Kernel::Rbf.default_scale(PREDICTORS),
            "quadratic": Kernel::Quadratic.default_scale(PREDICTORS),
        },
    });
    fs::write(folder.join("task.json"), header.to_string())?;
    Ok(())
}

fn write<'a>(path: &Path, values: impl Iterator<Item = &'a f64>) -> std::io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    for value in values {
        file.write_all(&value.to_le_bytes())?;
    }
    file.flush()
}
