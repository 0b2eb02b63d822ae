//! Paths from files, by what their headers say.

use testbed_io::PathFile;

fn read(text: &str) -> Result<PathFile, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("path.csv");
    std::fs::write(&file, text).unwrap();
    PathFile::read(&file).map_err(|error| error.to_string())
}

fn points(text: &str) -> Vec<[f64; 2]> {
    read(text).unwrap().points_m
}

#[test]
fn x_and_y_are_found_by_name_and_unit() {
    let expected = [[1.0, -0.5], [0.8, 0.25]];
    for text in [
        "x_m,y_m\n1,-0.5\n0.8,0.25\n",
        "s_m,x_m,y_m,kappa\n0,1,-0.5,9\n0.6,0.8,0.25,9\n",
        "y [m],x [m]\n-0.5,1\n0.25,0.8\n",
        "x_mm,y_mm\n1000,-500\n800,250\n",
        "X (cm);Y (cm)\n100;-50\n80;25\n",
        "t\tx/m\ty/mm\tx_std\n0\t1\t-500\t7\n0\t0.8\t250\t7\n",
        "# of a survey\nx_m,y_m\n1,-0.5\n0.8,0.25\n",
        "\u{feff}x_km,y_km\r\n0.001,-0.0005\r\n0.0008,0.00025\r\n",
    ] {
        let found = points(text);
        assert_eq!(found.len(), 2, "{text}");
        let off = found.iter().flatten().zip(expected.iter().flatten());
        assert!(
            off.into_iter().all(|(a, b)| (a - b).abs() < 1e-12),
            "{text}: {found:?}"
        );
        assert!(read(text).unwrap().notes.is_empty(), "{text}");
    }
}

#[test]
fn what_is_taken_for_granted_is_noted() {
    let plain = read("1,-0.5\n0.8,0.25\n").unwrap();
    assert_eq!(plain.points_m, [[1.0, -0.5], [0.8, 0.25]]);
    assert!(plain.notes[0].contains("no header"), "{:?}", plain.notes);
    let unnamed = read("x,y\n1,-0.5\n").unwrap();
    assert!(unnamed.notes[1].contains("column `y` of the path names no unit"));
}

#[test]
fn columns_that_are_no_places_in_a_plane_are_refused() {
    for (text, found) in [
        (
            "time_s,speed_mps\n0,1\n1,2\n",
            "no column `x` among: time_s, speed_mps",
        ),
        (
            "latitude,longitude\n48.1,11.5\n",
            "column `latitude` is in degrees",
        ),
        (
            "x_m,y_m,lon_deg\n1,2,11.5\n",
            "column `lon_deg` is in degrees",
        ),
        ("x_deg,y_deg\n1,2\n", "column `x_deg` is in `deg`"),
        ("x_m,z_m\n1,2\n", "no column `y` among: x_m, z_m"),
        ("x_m,x_mm,y_m\n1,2,3\n", "more than one column `x`"),
        ("0,1,0\n0.6,0.8,0.6\n", "3 columns without a header"),
        ("x_m,y_m\n1,2\n1,one\n", "line 3: `1,one` is no point"),
        ("x_m,y_m\n1,2\nnan,3\n", "line 3: `nan,3` is no point"),
        ("x_m,y_m\n1,2\n1\n", "line 3: `1` is no point"),
        ("", "no line with a point"),
    ] {
        let error = read(text).unwrap_err();
        assert!(error.contains(found), "{text}: {error}");
    }
}

#[test]
fn decimals_with_a_comma_are_refused_with_the_cure() {
    for text in [
        "x_m;y_m\n1,2;0,5\n",
        "x_m,y_m\n\"1,2\",\"0,5\"\n",
        "x_m\ty_m\n-1,2\t0,5\n",
        "x_m;y_m\n1;0\n1;5,3e-1\n",
    ] {
        let error = read(text).unwrap_err();
        assert!(error.contains("write decimals with a point"), "{error}");
    }
    let error = read("x_m,y_m\n1,\n").unwrap_err();
    assert!(error.contains("complete or delete the line"), "{error}");
}

#[test]
fn a_path_is_open_if_its_ends_are_farther_apart_than_its_points() {
    let arc = |turns: f64| {
        let angles = (0..40).map(|i| f64::from(i) / 40.0 * turns * std::f64::consts::TAU);
        let points: String = angles
            .map(|a| format!("{},{}\n", a.cos(), a.sin()))
            .collect();
        read(&format!("x_m,y_m\n{points}")).unwrap().gap_m()
    };
    assert_eq!(arc(1.0), None);
    assert!(arc(0.5).is_some_and(|gap_m| (gap_m - 2.0).abs() < 0.1));
    assert!(arc(0.95).is_some());
    let repeated = read("x_m,y_m\n0,0\n1,0\n1,1\n0,1\n0,0\n").unwrap();
    assert_eq!(repeated.gap_m(), None);
}
