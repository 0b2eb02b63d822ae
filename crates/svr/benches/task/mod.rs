//! The regression task of the benchmarks: trial 3 of the thesis on the simulated drives.

use std::path::Path;

/// Samples of 101 speed limits in a window of 10 s and 5 past speeds, and the next change of speed.
pub(crate) struct Task {
    pub(crate) predictors: Vec<f64>,
    pub(crate) response: Vec<f64>,
}

pub(crate) const PREDICTORS: usize = 106;
const HALF_WINDOW: usize = 50;
const PAST: usize = 5;

impl Task {
    /// The first `samples` of the drives; of the drives that have them, no more is read.
    pub(crate) fn load(samples: usize) -> Self {
        let task = Self::load_up_to(samples);
        assert!(
            task.response.len() == samples,
            "the drives have {} samples",
            task.response.len()
        );
        task
    }

    /// As [`Self::load`], or as many as there are.
    pub(crate) fn load_up_to(samples: usize) -> Self {
        // The crate and the rivals, which are a package of their own further down, have the drives above them.
        let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
        let folder = above
            .map(|folder| folder.join("fixtures/drives"))
            .find(|folder| folder.is_dir())
            .expect("the simulated drives");
        let mut task = Self {
            predictors: Vec::new(),
            response: Vec::new(),
        };
        for drive in 1..=12 {
            if task.response.len() < samples {
                let path = folder.join(format!("drive-{drive:02}.csv"));
                task.add(&std::fs::read_to_string(path).expect("a simulated drive"));
            }
        }
        task.response.truncate(samples);
        task.predictors.truncate(task.response.len() * PREDICTORS);
        task.predictors.shrink_to_fit();
        task
    }

    fn add(&mut self, csv: &str) {
        let rows = csv.lines().skip(1).map(|line| {
            let mut fields = line
                .split(',')
                .skip(1)
                .map(|field| field.parse::<f64>().expect("a number"));
            (
                fields.next().expect("a speed"),
                fields.next().expect("a limit"),
            )
        });
        let (raw, limit): (Vec<f64>, Vec<f64>) = rows.unzip();
        let speed = hann(&raw);
        for k in HALF_WINDOW.max(PAST)..speed.len() - HALF_WINDOW {
            self.predictors
                .extend_from_slice(&limit[k - HALF_WINDOW..=k + HALF_WINDOW]);
            self.predictors.extend_from_slice(&speed[k - PAST..k]);
            self.response.push(speed[k] - speed[k - 1]);
        }
    }
}

fn hann(raw: &[f64]) -> Vec<f64> {
    let weights = [0.25, 0.75, 1.0, 0.75, 0.25];
    let at = |k: isize| raw[k.clamp(0, raw.len() as isize - 1) as usize];
    let smoothed = (0..raw.len() as isize).map(|k| {
        weights
            .iter()
            .zip(-2..)
            .map(|(w, j)| w * at(k + j))
            .sum::<f64>()
            / 3.0
    });
    smoothed.collect()
}
