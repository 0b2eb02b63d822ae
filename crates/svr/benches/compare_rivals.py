#!/usr/bin/env python3
"""The crate svr beside LIBSVM (scikit-learn's SVR) and the crate linfa-svm: the same task, penalties, kernels and tolerance.

    python3 crates/svr/benches/compare_rivals.py
    python3 crates/svr/benches/compare_rivals.py --samples 16000 --kernels rbf quadratic

Needs cargo, numpy and scikit-learn (`pip install scikit-learn`); without them it says so and ends with 0. The task is that
of the benchmarks, 106 standardised predictors. Every fit has a process of its own, on one thread and, where there is
taskset, on one core; fits under a minute count with the fastest of three, beside the first, whose memory is still to come
from the system. Kernels are fitted to a violation of 1e-3 by all; the linear model by svr to a gap of 1e-8, by the others,
which take minutes for it beyond 2,000 samples, to a violation of 1e-3. The objectives are evaluated here or in rivals/ from
the coefficients, in double precision: the dual bounds the optimum from below, the primal from above. Memory is the peak of
the process, in brackets what it had before the fit. All programs predict 16,000 samples. LIBSVM caches as many MB of kernel
rows as svr may take in all.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")}
os.environ.update(ONE_THREAD)

try:
    import numpy as np
    import sklearn
    from sklearn.svm import SVR
except ImportError as missing:
    print(f"skipped: {missing}; `pip install scikit-learn` brings it")
    sys.exit(0)

RIVALS = Path(__file__).resolve().parents[1] / "rivals"
PROGRAM = RIVALS / "target/release/rivals"
KERNELS = ("linear", "rbf", "quadratic")
CACHE_MB = 1100
REPEAT_BELOW_S, REPETITIONS = 60.0, 3


def peak_memory_mb():
    try:
        with open("/proc/self/status") as file:
            return next(int(line.split()[1]) * 1024 / 1e6 for line in file if line.startswith("VmHWM:"))
    except (OSError, StopIteration):
        return None


def kernel_values(kernel, rows, others):
    """Of predictors that are divided by the kernel scale."""
    products = rows @ others.T
    if kernel == "quadratic":
        return (1.0 + products) ** 2
    squares = np.add.outer((rows**2).sum(axis=1), (others**2).sum(axis=1))
    return np.exp(np.minimum(2.0 * products - squares, 0.0))


def objectives(kernel, x, y, beta, bias, c, epsilon):
    """Primal and dual of f(x) = sum beta K(x_i, x) + b, and by how much the dual's constraints are violated."""
    if kernel == "linear":
        products = x @ (x.T @ beta)
    else:
        used = np.flatnonzero(beta)
        blocks = [kernel_values(kernel, x[i : i + 256], x[used]) @ beta[used] for i in range(0, len(x), 256)]
        products = np.concatenate(blocks)
    square = beta @ products
    primal = 0.5 * square + c * np.maximum(np.abs(y - products - bias) - epsilon, 0.0).sum()
    dual = y @ beta - epsilon * np.abs(beta).sum() - 0.5 * square
    return primal, dual, max(abs(beta.sum()), np.abs(beta).max() - c)


def fit_libsvm(kernel, folder):
    """One JSON line, as of the rivals program."""
    header = json.loads((folder / "task.json").read_text())
    read = lambda name: np.fromfile(folder / name, dtype="<f8")
    x, y = read("predictors.f64").reshape(-1, header["predictors"]), read("response.f64")
    scale = header["kernel_scale"][kernel]
    c, epsilon = header["box_constraint"], header["tube_epsilon"]
    common = dict(C=c, epsilon=epsilon, tol=header["tolerance"], cache_size=CACHE_MB)
    own = dict(kernel="rbf") if kernel == "rbf" else dict(kernel="poly", degree=2, coef0=1.0)
    model = SVR(kernel="linear", **common) if kernel == "linear" else SVR(gamma=scale**-2, **own, **common)
    before_mb = peak_memory_mb()
    seconds = []
    while not seconds or (seconds[0] < REPEAT_BELOW_S and len(seconds) < REPETITIONS):
        start = time.perf_counter()
        model.fit(x, y)
        seconds.append(time.perf_counter() - start)
    peak_mb = peak_memory_mb()
    probe = read("probe.f64").reshape(-1, header["predictors"])
    start = time.perf_counter()
    model.predict(probe)
    predict_seconds = time.perf_counter() - start
    beta = np.zeros(len(y))
    beta[model.support_] = model.dual_coef_[0]
    primal, dual, infeasibility = objectives(kernel, x / scale, y, beta, model.intercept_[0], c, epsilon)
    print(json.dumps(dict(
        program="LIBSVM", kernel=kernel, samples=len(y), seconds=min(seconds), first_seconds=seconds[0],
        primal=primal, dual=dual, infeasibility=infeasibility, support_vectors=len(model.support_),
        status="optimal" if model.fit_status_ == 0 else "not optimal", before_mb=before_mb, peak_mb=peak_mb,
        predict_samples=len(probe), predict_seconds=predict_seconds,
    )))


def run(command, core, time_limit_s):
    """What the command says of its fit; nothing where it takes too long."""
    pinned = ["taskset", "-c", str(core)] if shutil.which("taskset") else []
    try:
        done = subprocess.run([*pinned, *map(str, command)], check=True, capture_output=True, timeout=time_limit_s)
    except subprocess.TimeoutExpired:
        return None
    return json.loads(done.stdout)


def show(kernel, samples, program, result, ours, time_limit_s):
    start = f"{kernel:9}  {samples:6}  {program:6}"
    if result is None:
        print(f"{start}  stopped after {time_limit_s:.0f} s", flush=True)
        return
    memory = lambda value: "?" if value is None else f"{value:.0f}"
    print(
        f"{start}  {result['first_seconds']:8.3f}  {result['seconds']:8.3f}  {result['seconds'] / ours['seconds']:6.1f}  "
        f"{result['dual']:16.8f}  {result['primal']:16.8f}  {result['primal'] - result['dual']:8.1e}  {result['infeasibility']:8.1e}  "
        f"{result['support_vectors']:7}  {memory(result['peak_mb']):>5} ({memory(result['before_mb']):>3})  "
        f"{result['predict_seconds']:9.3f}  {result['predict_seconds'] / ours['predict_seconds']:6.1f}  {result['status']}",
        flush=True,
    )


def load():
    return ", ".join(f"{x:.2f}" for x in os.getloadavg()) if hasattr(os, "getloadavg") else "unknown"


def main():
    parser = argparse.ArgumentParser(description="Compares svr with LIBSVM and linfa-svm.")
    parser.add_argument("--samples", type=int, nargs="+", default=[2000, 8000], help="of the task; 2000 8000")
    parser.add_argument("--kernels", nargs="+", choices=KERNELS, default=KERNELS)
    parser.add_argument("--linear-up-to", type=int, default=2000, help="samples to which the rivals fit a linear model; 2000")
    parser.add_argument("--linfa-up-to", type=int, default=8000, help="samples to which linfa-svm fits, at most 8000")
    parser.add_argument("--time-limit", type=float, default=300.0, help="s for one process of a rival; 300")
    cores = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [0]
    parser.add_argument("--core", type=int, default=cores[-1], help=f"to run on; {cores[-1]}")
    parser.add_argument("--fit", choices=KERNELS, help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.fit:
        fit_libsvm(arguments.fit, arguments.folder)
        return
    if shutil.which("cargo") is None:
        print("skipped: there is no cargo to build the rivals program with")
        return
    build = ["cargo", "build", "--release", "--quiet", "--target-dir", RIVALS / "target"]
    subprocess.run([str(word) for word in build], check=True, cwd=RIVALS)

    print(f"scikit-learn {sklearn.__version__}, numpy {np.__version__}; load of the machine {load()}")
    print(
        f"{'kernel':9}  {'n':>6}  {'by':6}  {'first s':>8}  {'fit in s':>8}  {'ratio':>6}  "
        f"{'dual objective':>16}  {'primal objective':>16}  {'gap':>8}  {'infeas.':>8}  {'support':>7}  {'peak MB':>12}  {'predict s':>9}  {'ratio':>6}  status"
    )
    for samples in arguments.samples:
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([PROGRAM, "--samples", str(samples), "--export", folder], check=True)
            for kernel in arguments.kernels:
                fit = [PROGRAM, "--samples", samples, "--kernel", kernel, "--program"]
                ours = run([*fit, "svr"], arguments.core, None)
                show(kernel, samples, "svr", ours, ours, None)
                if kernel == "linear" and samples > arguments.linear_up_to:
                    continue
                rivals = [("LIBSVM", [sys.executable, __file__, "--fit", kernel, "--folder", folder])]
                if samples <= min(arguments.linfa_up_to, 8000):
                    rivals.append(("linfa", [*fit, "linfa"]))
                for program, command in rivals:
                    result = run(command, arguments.core, arguments.time_limit)
                    show(kernel, samples, program, result, ours, arguments.time_limit)
    print(f"load of the machine at the end {load()}")


if __name__ == "__main__":
    main()
