//! Any table, whole and damaged.

use std::collections::BTreeMap;

use proptest::collection::vec;
use proptest::prelude::*;
use testbed_io::log_file::{LogFormat, LogTable, Values, read_bytes};

use super::{FORMATS, assert_same, bytes, column};

fn float() -> impl Strategy<Value = f64> {
    let special = [
        f64::NAN,
        -0.0,
        f64::INFINITY,
        f64::NEG_INFINITY,
        5e-324,
        -1e-310,
        f64::MAX,
    ];
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        -1e3..1e3,
        proptest::sample::select(special.to_vec())
    ]
}

fn text() -> impl Strategy<Value = String> {
    let parts = [
        "a", ",", "\"", "\n", "\r", "#", "\u{feff}", "é", "🤖", " ", "\0", "\\", "inf", "1",
    ];
    vec(proptest::sample::select(parts.to_vec()), 0..5).prop_map(|parts| parts.concat())
}

fn values(rows: usize) -> impl Strategy<Value = Values> {
    prop_oneof![
        vec(float(), rows).prop_map(Values::Float),
        vec(any::<i64>(), rows).prop_map(Values::Integer),
        vec(text(), rows).prop_map(Values::Text),
    ]
}

/// Any table, with the columns that MCAP needs or without.
fn any_table(mcap: bool) -> impl Strategy<Value = LogTable> {
    let sizes = (0_usize..6, 0_usize..6);
    let columns = sizes.prop_flat_map(|(rows, columns)| {
        let needed = (
            vec(0..=i64::from(u32::MAX), rows),
            vec(any::<i64>(), rows),
            vec(0.0..1e9, rows),
        );
        let pose = proptest::bool::ANY;
        (
            vec((text(), values(rows)), columns),
            needed,
            pose,
            vec(float(), rows),
        )
    });
    (columns, text()).prop_map(move |((columns, needed, pose, x), meta)| {
        let mut all = BTreeMap::new();
        for (name, values) in columns {
            all.insert(format!("n{name}_"), values);
        }
        if pose {
            for name in ["true_x_m", "true_y_m", "true_heading_rad"] {
                all.insert(name.to_owned(), Values::Float(x.clone()));
            }
        }
        if mcap {
            all.insert("tick".to_owned(), Values::Integer(needed.0));
            all.insert("robot".to_owned(), Values::Integer(needed.1));
            all.insert("time_s".to_owned(), Values::Float(needed.2));
        }
        let columns = all
            .iter()
            .map(|(name, values)| column(name, values.clone()));
        let meta = serde_json::json!({ "note": meta }).to_string();
        LogTable::new(&meta, columns.rev().collect()).unwrap()
    })
}

proptest! {
    #[test]
    fn any_table_comes_back(plain in any_table(false), mcap in any_table(true)) {
        for (table, format) in [(&plain, LogFormat::Csv), (&plain, LogFormat::Parquet), (&mcap, LogFormat::Mcap)] {
            assert_same(&read_bytes(&bytes(table, format), format).unwrap(), table, format);
        }
    }

    #[test]
    fn damage_never_panics(
        table in any_table(true),
        hits in vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        cut in proptest::option::of(any::<prop::sample::Index>()),
    ) {
        for format in FORMATS {
            let mut bytes = bytes(&table, format);
            for (at, value) in &hits {
                let at = at.index(bytes.len());
                bytes[at] = *value;
            }
            if let Some(cut) = &cut {
                bytes.truncate(cut.index(bytes.len()));
            }
            let _ = read_bytes(&bytes, format);
        }
    }
}
