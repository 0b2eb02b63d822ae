//! From the axes of the server to the floor.

use serde::{Deserialize, Serialize};
use unicycle_cbf::Pose;

use super::frame::Body;

/// By how much the norm of a quaternion may differ from 1.
const NORM_TOLERANCE: f64 = 0.1;

/// Which axis of the server points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Up {
    /// As the server is delivered; the floor is X and −Z
    #[default]
    Y,
    /// The floor is X and Y
    Z,
}

/// Where a body is on the floor; its x axis points forward. None if its quaternion is no rotation.
///
/// NaN stays NaN.
#[must_use]
pub fn floor_pose(body: &Body, up: Up) -> Option<Pose> {
    let [pos_x, pos_y, pos_z] = body.position_m.map(f64::from);
    let quaternion = body.quaternion.map(f64::from);
    let norm = quaternion
        .iter()
        .map(|part| part * part)
        .sum::<f64>()
        .sqrt();
    if (norm - 1.0).abs() > NORM_TOLERANCE {
        return None;
    }
    let [x, y, z, w] = quaternion.map(|part| part / norm);
    let (x_m, y_m, heading_rad) = match up {
        Up::Y => {
            // The body's z axis shows the turn about Y, with a tilt as well as its x axis to first order.
            let heading_rad = (2.0 * (w * y + x * z)).atan2(1.0 - 2.0 * (x * x + y * y));
            (pos_x, -pos_z, heading_rad)
        }
        Up::Z => {
            let heading_rad = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
            (pos_x, pos_y, heading_rad)
        }
    };
    Some(Pose {
        x_m,
        y_m,
        heading_rad,
    })
}
