//! The same drive in many forms.

use std::path::Path;

use drive_log::{Channel, Layout, LayoutChoice, read_bytes};

use crate::{log, read};

/// 36 km/h and 39.6 km/h at 0 and 0.1 s.
fn is_the_drive(text: impl AsRef<[u8]>) {
    let log = log(text);
    assert_eq!(log.time_s(), [0.0, 0.1]);
    assert_eq!(log.channel(Channel::Speed).unwrap(), [10.0, 11.0]);
}

#[test]
fn canonical_in_any_dress() {
    is_the_drive("time_s,speed_mps\n0,10\n0.1,11\n");
    is_the_drive("t,v\n0,10\n0.1,11");
    is_the_drive("time_s;speed_kmh\n0;36\n0,1;39,6\n");
    is_the_drive("time_ms\tspeed_kmh\r\n0\t36\r\n100\t39.6\r\n");
    is_the_drive("t   v\n  0    10\n  0.1  11\n");
    is_the_drive("\u{feff}\n Time_S , \"Speed_mps\"\n0,10\n\n0.1,11\n\n\n");
    is_the_drive("note,time_s,speed_mps\n\"a, b\",0,10\n\"c\",0.1,\"11\"\n");
    is_the_drive(b"temp_\xb0c,time_s,speed_mps\n20,0,10\n21,0.1,11\n");
    is_the_drive("time_s;speed_mps\n0;10\n0,1;11,0\n");
    is_the_drive(
        zstd::encode_all("t,v\n0,10\n0.1,11\n".as_bytes(), 1)
            .unwrap()
            .as_slice(),
    );
}

#[test]
fn canonical_in_other_spellings() {
    is_the_drive("Time [s],Speed (km/h)\n0,36\n0.1,39.6\n");
    is_the_drive("time-ms;SPEED [m/s]\n0;10\n100;11\n");
    is_the_drive("timestamp,speed cm/s\n2026-03-29 00:00:00.0,1000\n2026-03-29 00:00:00.1,1100\n");
    // canonical words come first
    is_the_drive("time_s,speed_mps,Speed (km/h),Time [ms]\n0,10,1,7\n0.1,11,1,7\n");
    let log = log("time_s,speed_mps,Grade [%],Battery Voltage [V],soc 1,soc\n0,1,100,320,50,60\n");
    assert_eq!(
        log.channel(Channel::Slope).unwrap(),
        [std::f64::consts::FRAC_PI_4]
    );
    assert_eq!(log.channel(Channel::BatteryVoltage).unwrap(), [320.0]);
    assert!(
        log.channel(Channel::StateOfCharge).is_none(),
        "numbers are no units"
    );
    let error = read("time_s,Speed [km/h],Speed (mph)\n0,1,1\n")
        .unwrap_err()
        .to_string();
    assert!(error.contains("are both speed"), "{error}");
}

#[test]
fn a_decimal_comma_after_many_whole_numbers() {
    let whole: String = (0..50).map(|i| format!("{i};1\n")).collect();
    let log = log(format!("time_s;speed_mps\n{whole}50,5;1,25\n"));
    assert_eq!(
        (log.time_s()[50], log.channel(Channel::Speed).unwrap()[50]),
        (50.5, 1.25)
    );
}

#[test]
fn every_canonical_channel_and_unit() {
    let log = log(
        "time_s,speed_mps,accel_mps2,speed_limit_kmh,accelerometer_mps2,grade_pct,elevation_m,distance_km,lead_gap_m,lead_speed_mps,battery_voltage_v,\
         battery_current_a,soc_pct,motor_torque_nm,accelerator_pedal_pct,brake_fraction,aux_power_kw,heating_power_w,heating_request_w,\
         ambient_temperature_degf,battery_temperature_degc,latitude_deg,longitude_deg\n0,1,2,36,3,100,4,14,5,6,7,8,9,10,40,0.5,11,12,13,50,7,52,13\n",
    );
    let values: Vec<f64> = Channel::ALL
        .into_iter()
        .map(|c| log.channel(c).unwrap()[0])
        .collect();
    let atan_1 = std::f64::consts::FRAC_PI_4;
    assert_eq!(
        values,
        [
            1.0, 2.0, 10.0, 3.0, atan_1, 4.0, 14_000.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 40.0, 50.0,
            11_000.0, 12.0, 13.0, 10.0, 7.0, 52.0, 13.0
        ]
    );
}

#[test]
fn positions_in_other_units_are_no_channel() {
    let log = log("time_s,speed_mps,latitude_gps,longitude_e7\n0,1,52,13\n");
    assert_eq!(log.channel(Channel::Latitude), None);
    assert_eq!(log.channel(Channel::Longitude), None);
}

#[test]
fn words_for_missing() {
    for word in [
        "", "NaN", "nan", "NA", "N/A", "null", "-", "inf", "-Inf", "Infinity", "1e999",
    ] {
        let log = log(format!("time_s,speed_mps,soc_pct\n0,1,50\n0.1,2,{word}\n"));
        assert!(
            log.channel(Channel::StateOfCharge).unwrap()[1].is_nan(),
            "{word:?}"
        );
    }
}

#[test]
fn nds_br() {
    let file = read(
        "DRIVER;LONG;LAT;DAY;DAY_CORRIGIDO;03:00:00;TRIP;TIME_ACUM;SPD_MPH;SPD_KMH;ALTITUDE_FT;LIMITE_VEL\n\
         B;-49,2;-25,4;31/8/2019;31/8/2019;23:59:59;5;0;22,4;36;3050197;NPI\n\
         B;-49,2;-25,4;1/9/2019;1/9/2019;00:00:00;5;1;22,4;36,36;3050197;54\n\
         B;-49,2;-25,4;1/9/2019;1/9/2019;10:00:00;6;0;22,4;18;3050197;54\n\
         B;-49,2;-25,4;1/9/2019;1/9/2019;10:00:01;6;1;22,4;18;3050197;54\n",
    )
    .unwrap();
    assert_eq!(file.layout, "nds-br");
    let [first, second] = &file.logs[..] else {
        panic!("two trips");
    };
    assert_eq!(first.time_s()[1] - first.time_s()[0], 1.0);
    assert_eq!(first.channel(Channel::Speed), Some(&[10.0, 10.1][..]));
    let limit_mps = first.channel(Channel::SpeedLimit).unwrap();
    assert!(limit_mps[0].is_nan() && limit_mps[1] == 15.0);
    assert_eq!(second.channel(Channel::Speed), Some(&[5.0, 5.0][..]));
}

#[test]
fn bmw_i3() {
    let file = read(
        "Time [s];Velocity [km/h];Battery Current [A];SoC [%];max. SoC [%);AirCon Power [kW] ;Heating Power CAN [kW];\
         Ambient Temperature [°C]\n0;36;-2,5;86,9;90;0,4;1,2;25\n",
    )
    .unwrap();
    assert_eq!(file.layout, "bmw-i3");
    let channels: Vec<(Channel, f64)> = file.logs[0]
        .channels()
        .map(|(c, values)| (c, values[0]))
        .collect();
    let expected = [
        (Channel::Speed, 10.0),
        (Channel::BatteryCurrent, 2.5),
        (Channel::StateOfCharge, 86.9),
        (Channel::AuxPower, 400.0),
        (Channel::HeatingPower, 1200.0),
        (Channel::AmbientTemperature, 25.0),
    ];
    assert_eq!(channels, expected);
}

#[test]
fn rsk_twizy_over_midnight() {
    let log = log(
        "Date,Time,Soc,Speed,Mode,ALT,GpsSpeed,WindSpeedAv,SpeedLimit\n\
         02/28/2021,23:59:59,80,36,D,10,10,2,60\n03/01/2021,00:00:00,80,36,D,10,10,2,60\n",
    );
    assert_eq!(log.time_s(), [0.0, 1.0]);
    assert_eq!(log.channel(Channel::SpeedLimit).unwrap()[0], 60.0 / 3.6);
}

#[test]
fn openacc_is_a_log_per_car() {
    let file = read(
        "Date,9,10,2019\r\nVehicle_order,TARGET,MODELX,MODEL3,MODELS,\r\nNumber_of_vehicles,4\r\nACC,0\r\nDistance_setting,\r\n\
         Time,Speed2,Alt2,Speed3,Speed4,IVS2,IVS3\r\n5.0,10,229,11,,7,8\r\n5.1,10,229,11,,7,8\r\n",
    )
    .unwrap();
    assert_eq!(file.layout, "openacc");
    let names: Vec<&str> = file.logs.iter().map(drive_log::RawLog::name).collect();
    assert_eq!(
        names,
        ["log#MODELX", "log#MODEL3"],
        "a car without speed is left out"
    );
    assert!(
        file.logs[0].channel(Channel::LeadGap).is_none(),
        "nobody recorded is ahead of car 2"
    );
    assert_eq!(file.logs[1].channel(Channel::LeadGap).unwrap(), [7.0, 7.0]);
    assert_eq!(
        file.logs[1].channel(Channel::LeadSpeed).unwrap(),
        [10.0, 10.0]
    );
}

#[test]
fn cycles_of_both_kinds() {
    let file = read("cycSecs,cycMps,cycGrade,cycRoadType\n0,0,0.01,0\n1,10,0.01,0\n").unwrap();
    assert_eq!(file.layout, "cycles");
    assert_eq!(
        file.logs[0].channel(Channel::Slope).unwrap()[0],
        0.01_f64.atan()
    );

    let file = read("Time (s);NEDC;SORT 1\n0;0;36\n1;36;0\n2;36;\n").unwrap();
    assert_eq!(file.layout, "cycles");
    let lengths: Vec<(&str, usize)> = file.logs.iter().map(|l| (l.name(), l.len())).collect();
    assert_eq!(lengths, [("log#NEDC", 3), ("log#SORT 1", 2)]);
    assert_eq!(
        file.logs[0].channel(Channel::Speed).unwrap(),
        [0.0, 10.0, 10.0]
    );
}

#[test]
fn igdir_without_a_header() {
    let file = read(three_columns(3.6)).unwrap();
    assert_eq!(file.layout, "igdir");
    let [speed, accel] = [Channel::Speed, Channel::Accel].map(|c| file.logs[0].channel(c).unwrap());
    assert!((speed[15] - 9.29).abs() < 0.01 && (accel[15] - 1.0).abs() < 0.01);
}

/// Time, speed times `factor` and acceleration of a drive that speeds up and brakes.
fn three_columns(factor: f64) -> String {
    let row = |i: u32| {
        let phase = f64::from(i) / 10.0;
        let (speed, accel) = (10.0 * (1.0 - phase.cos()), phase.sin());
        format!("{i}\t{:.2}\t{accel:.3}\n", factor * speed)
    };
    (0..100).map(row).collect()
}

/// Three columns of numbers may be anything: only a speed in km/h and its acceleration are taken.
#[test]
fn three_columns_without_a_header_are_checked_against_each_other() {
    for factor in [1.0, 2.237, 36.0] {
        let error = read(three_columns(factor)).unwrap_err().to_string();
        assert!(
            error.contains("km/h") && error.contains("headers with units"),
            "{error}"
        );
    }
    assert!(
        read("0\t0.0\t0.00\n1\t36.0\t0.50\n").is_err(),
        "too short to tell"
    );
}

#[test]
fn a_layout_of_ones_own() {
    let layout = Layout::from_toml_str(
        "mine",
        "delimiter = \";\"\ndecimal = \",\"\nskip_lines = 2\ntime = { header = \"zeit [MS]\", unit = \"ms\" }\n[channels]\n\
         speed = { header = \"V\", unit = \"km/h\" }\nbattery_current = { header = \"I\", unit = \"A\", sign = -1 }\n",
    )
    .unwrap();
    let choice = LayoutChoice::Described(layout);
    let text = "logger 7\nmade; in; a; hurry\nZeit (ms);I;v\n0;-1,5;36\n100;-2;36\n";
    let file = read_bytes(Path::new("a/trip.7.csv.gz"), text.as_bytes(), &choice).unwrap();
    assert_eq!(
        (file.layout.as_str(), file.logs[0].name()),
        ("mine", "trip.7")
    );
    assert_eq!(file.logs[0].time_s(), [0.0, 0.1]);
    assert_eq!(
        file.logs[0].channel(Channel::BatteryCurrent).unwrap(),
        [1.5, 2.0]
    );
    // what the user names must be there
    let error = read_bytes(Path::new("x"), b"1\n2\nZeit (ms);v\n0;36\n", &choice)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("battery_current_a") && error.contains("\"I\""),
        "{error}"
    );
}

#[test]
fn columns_by_number() {
    let text = "no_header = true\ntime = { column = 2, unit = \"s\" }\n[channels]\nspeed = { column = 1, unit = \"m/s\" }\n";
    let choice = LayoutChoice::Described(Layout::from_toml_str("mine", text).unwrap());
    let file = read_bytes(Path::new("x"), b"10 0 7\n11 1 7\n", &choice).unwrap();
    assert_eq!(file.logs[0].time_s(), [0.0, 1.0]);
    assert!(read_bytes(Path::new("x"), b"10\n11\n", &choice).is_err());
}

#[test]
fn the_hash_is_that_of_the_file() {
    let file = read("t,v\n0,1\n").unwrap();
    assert_eq!(
        file.sha256, "a15167f58d1c49ef5c6ef9a0cf6039452b738b2036e74cdf250557154af59383",
        "as sha256sum says"
    );
}

/// A logger that lost power: the row that it was writing is left out, and that is said.
#[test]
fn a_last_row_that_is_cut_off() {
    let whole = "time_s,speed_mps,elevation_m\n0,5,500\n1,6,501\n2,7,502\n";
    for cut in ["3,", "3", "3,8"] {
        let text = format!("{whole}{cut}");
        let file = read_bytes(Path::new("log.csv"), text.as_bytes(), &LayoutChoice::Auto).unwrap();
        let log = file.logs.into_iter().next().unwrap();
        assert_eq!(log.time_s(), [0.0, 1.0, 2.0], "{cut:?}");
        let checked = drive_log::check(log);
        let finding = &checked.findings[0];
        assert_eq!(finding.kind, drive_log::FindingKind::CutOff, "{cut:?}");
        assert_eq!((finding.from_s, finding.to_s), (2.0, 2.0));
    }
    let ended = format!("{whole}3,8\n");
    assert!(read_bytes(Path::new("log.csv"), ended.as_bytes(), &LayoutChoice::Auto).is_err());
}

/// Empty cells at the end of the last row are not blanks to be trimmed.
#[test]
fn empty_cells_at_the_end_of_a_tab_separated_file() {
    for end in ["", "\n", "\r\n\n"] {
        let text = format!("time_s\tspeed_mps\televation_m\n0\t5\t500\n1\t6\t{end}");
        let file = read_bytes(Path::new("log.tsv"), text.as_bytes(), &LayoutChoice::Auto).unwrap();
        assert_eq!(file.logs[0].time_s(), [0.0, 1.0], "{end:?}");
    }
}
