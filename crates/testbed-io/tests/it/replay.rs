//! Run logs in every format, and their replay.

use testbed_io::log_file::{self, LogFormat};
use testbed_io::{Judged, RunFile};
use testbed_sim::{Disturbances, Verdict};
use unicycle_cbf::{Preset, Testbed};

fn spec(preset: Preset) -> RunFile {
    let mut scenario = Testbed::Robotarium.scenario("decay", preset).unwrap();
    scenario.duration_s = 20.0;
    RunFile {
        seed: 3,
        scenario,
        disturbances: Disturbances::HARD,
        link: None,
    }
}

#[test]
fn every_decision_is_repeated_bit_for_bit_from_every_format() {
    for preset in [Preset::Thesis, Preset::Hardened] {
        let (run, _) = spec(preset).simulate().unwrap();
        let table = run.to_table().unwrap();
        for format in [LogFormat::Csv, LogFormat::Parquet, LogFormat::Mcap] {
            let mut bytes = Vec::new();
            log_file::write(&table, format, &mut bytes).unwrap();
            let read = log_file::read_bytes(&bytes, format).unwrap();
            let replay = read.run_log().unwrap().replay().unwrap();
            assert_eq!(replay.decisions, run.ticks.len());
            assert_eq!(replay.different, 0, "{format:?}: {:?}", replay.first);
        }
    }
}

#[test]
fn a_log_is_not_safer_than_its_session_was() {
    let (mut run, summary) = spec(Preset::Hardened).simulate().unwrap();
    assert_eq!(summary.verdict, Verdict::Safe);
    let doubts = vec!["robot 2 went on".to_owned()];
    for (verdict, doubts) in [
        (Verdict::NotKnown, doubts),
        (Verdict::Unsafe, Vec::new()),
        (Verdict::Safe, Vec::new()),
    ] {
        let judged = Judged { verdict, doubts };
        run.judged = Some(judged.clone());
        let table = run.to_table().unwrap();
        for format in [LogFormat::Csv, LogFormat::Parquet, LogFormat::Mcap] {
            let mut bytes = Vec::new();
            log_file::write(&table, format, &mut bytes).unwrap();
            let read = log_file::read_bytes(&bytes, format).unwrap();
            assert_eq!(read.judged().unwrap().as_ref(), Some(&judged));
            let mut replay = read.run_log().unwrap().replay().unwrap();
            assert_eq!((replay.different, replay.verdict), (0, Verdict::Safe));
            judged.apply(&mut replay);
            assert_eq!((replay.verdict, &replay.doubts), (verdict, &judged.doubts));
        }
    }
}

#[test]
fn a_changed_decision_and_a_changed_pose_are_found() {
    let (run, _) = spec(Preset::Hardened).simulate().unwrap();
    let log = run.to_table().unwrap().run_log().unwrap();
    let mut changed = log.clone();
    changed.rows[500].decided[0] += 1e-15;
    let replay = changed.replay().unwrap();
    assert_eq!((replay.different, replay.first.unwrap().column), (1, "x_m"));

    let mut changed = log.clone();
    let row = changed
        .rows
        .iter_mut()
        .skip(600)
        .find(|row| row.seen.is_some())
        .unwrap();
    row.seen.as_mut().unwrap().pose.x_m += 1e-6;
    assert!(changed.replay().unwrap().different > 10);

    let mut cut = log.clone();
    cut.rows.truncate(501);
    let replay = cut.replay().unwrap();
    assert_eq!(replay.decisions, 500);
    assert!(replay.truncated && replay.verdict == Verdict::NotKnown);

    let mut shuffled = log;
    shuffled.rows.swap(100, 200);
    let error = shuffled.replay().unwrap_err().to_string();
    assert!(error.contains("not in order at step 50"), "{error}");
}

#[test]
fn tables_that_are_no_run_logs_are_refused() {
    let (run, _) = spec(Preset::Thesis).simulate().unwrap();
    let table = run.to_table().unwrap();
    let mut columns = table.clone().into_columns();
    columns.retain(|column| column.name != "force_n");
    let without = log_file::LogTable::new(table.meta(), columns.clone()).unwrap();
    let error = without.run_log().unwrap_err().to_string();
    assert!(error.contains("no column `force_n` of numbers"), "{error}");
    let other = log_file::LogTable::new("{\"a\": 1}", columns).unwrap();
    let error = other.run_log().unwrap_err().to_string();
    assert!(error.contains("the settings in the run log: "), "{error}");
}

#[test]
fn a_log_cut_between_two_lines_is_not_called_safe() {
    let (run, summary) = spec(Preset::Hardened).simulate().unwrap();
    assert_eq!(summary.verdict, Verdict::Safe);
    let mut bytes = Vec::new();
    log_file::write(&run.to_table().unwrap(), LogFormat::Csv, &mut bytes).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let replay = |lines: usize, old: bool| {
        let mut text = text.split_inclusive('\n').take(lines).collect::<String>();
        if old {
            text = text.replace(" end\n", "\n");
        }
        let table = log_file::read_bytes(text.as_bytes(), LogFormat::Csv).unwrap();
        table.run_log().unwrap().replay().unwrap()
    };
    for old in [false, true] {
        let whole = replay(lines.len(), old);
        assert!(!whole.truncated && whole.verdict == Verdict::Safe);
        for missing in [1, 2, 3, 400] {
            let cut = replay(lines.len() - missing, old);
            assert!(cut.truncated, "{missing}");
            assert_eq!(cut.verdict, Verdict::NotKnown);
            assert_eq!(cut.doubts, ["the end of the log is missing"]);
        }
    }
}
