//! Degrees east jump by 360 where a drive crosses the meridian of 180°.

/// The same longitude, at most half a turn from another one.
pub(crate) fn turned_deg(east_deg: f64, near_deg: f64) -> f64 {
    east_deg - 360.0 * ((east_deg - near_deg) / 360.0).round()
}

/// Longitudes along a drive, without jumps.
pub(crate) fn unrolled_deg(east_deg: &[f64]) -> Vec<f64> {
    let mut last = None;
    let turned = |&east: &f64| {
        let east = turned_deg(east, last.unwrap_or(east));
        last = Some(east).filter(|east| east.is_finite()).or(last);
        east
    };
    east_deg.iter().map(turned).collect()
}
