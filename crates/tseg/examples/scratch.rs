pub fn wltc(len: usize) -> (Vec<f64>, Vec<f64>) {
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fixtures/cycles/wltc-3b.csv"
    ))
    .unwrap();
    let v: Vec<f64> = text
        .lines()
        .skip(1)
        .map(|l| {
            let f: Vec<&str> = l.split(',').collect();
            f[1].parse::<f64>().unwrap() / 3.6
        })
        .collect();
    let mut fine = Vec::new();
    for w in v.windows(2) {
        for i in 0..10 {
            fine.push(w[0] + (w[1] - w[0]) * i as f64 / 10.0);
        }
    }
    let n0 = fine.len();
    let v: Vec<f64> = (0..len).map(|i| fine[i % n0]).collect();
    let w: Vec<f64> = (1..=5)
        .map(|j| 0.5 * (1.0 - (2.0 * std::f64::consts::PI * j as f64 / 6.0).cos()))
        .collect();
    let ws: f64 = w.iter().sum();
    let at = |i: i64| v[i.clamp(0, len as i64 - 1) as usize];
    let s: Vec<f64> = (0..len as i64)
        .map(|i| (0..5).map(|j| w[j as usize] * at(i + j - 2)).sum::<f64>() / ws)
        .collect();
    let mut a: Vec<f64> = s.windows(2).map(|w| (w[1] - w[0]) / 0.1).collect();
    a.push(*a.last().unwrap());
    for x in &mut a {
        if x.abs() < 0.4 {
            *x = 0.0
        }
    }
    let _ = &text;
    (
        tseg::Scale::ZScore.scaled(&s),
        tseg::Scale::ZScore.scaled(&a),
    )
}
struct Instant(f64);
impl Instant {
    fn now() -> Self {
        Self(cpu())
    }
    fn elapsed(&self) -> std::time::Duration {
        std::time::Duration::from_secs_f64(cpu() - self.0)
    }
}
fn cpu() -> f64 {
    let mut t = 0.0;
    for d in std::fs::read_dir("/proc/self/task").unwrap() {
        let s = std::fs::read_to_string(d.unwrap().path().join("schedstat")).unwrap();
        t += s.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9;
    }
    t
}
fn main() {
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build_global()
        .unwrap();
    let args: Vec<usize> = std::env::args()
        .skip(1)
        .map(|a| a.parse().unwrap())
        .collect();
    let (n, k) = (args[0], args[1]);
    let (v, a) = wltc(n);
    let series = tseg::Series::new(&[(&v, 1.8), (&a, 1.0)]).unwrap();
    let cells = n as f64 * n as f64 / 2.0;
    let t = Instant::now();
    let o = tseg::Dynamic::new(tseg::Cost::ZScale, k)
        .unwrap()
        .with_min_length(args[2])
        .segment_with(&series, &|d| {
            if args.len() > 3 {
                eprintln!("{d:.3} {:.2}", t.elapsed().as_secs_f64());
            }
            std::ops::ControlFlow::Continue(())
        })
        .unwrap();
    let e = t.elapsed().as_secs_f64();
    println!(
        "dp {e:.4} s, {:.2} ns/cell cost {} {:?} {:?}",
        e / cells * 1e9,
        o.cost,
        o.certificate,
        &o.segmentation.boundaries()[..3]
    );
    println!(
        "{}",
        std::fs::read_to_string("/proc/self/status")
            .unwrap()
            .lines()
            .find(|l| l.starts_with("VmHWM"))
            .unwrap()
    );
}
