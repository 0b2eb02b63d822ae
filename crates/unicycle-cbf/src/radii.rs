//! How far the robots of the testbeds reach.

/// Khepera III, about the middle of the axle, in m
pub(crate) const KHEPERA_M: f64 = 0.065;
/// Robotarium, about the middle of the axle, in m
pub(crate) const ROBOTARIUM_M: f64 = 0.055;

/// That of the robots with this wheel base, in m.
pub(crate) fn with_wheel_base(wheel_base_m: f64) -> Option<f64> {
    let same = |from_m: f64, to_m: f64| (from_m..=to_m).contains(&wheel_base_m);
    if same(0.0884, 0.0886) {
        Some(KHEPERA_M)
    } else if same(0.1049, 0.1101) {
        Some(ROBOTARIUM_M)
    } else {
        None
    }
}
