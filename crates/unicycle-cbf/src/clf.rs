//! Control Lyapunov functions of speed, turn rate and path (thesis 3.4, 3.5 and section 3.2).

use crate::lateral::Lateral;
use crate::lie::Lie;
use crate::pose::State;
use crate::unicycle::Body;

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// `V1 = (v − v_d)²`
#[must_use]
pub fn speed(body: &Body, state: &State, desired_speed_mps: f64) -> Lie {
    let error = state.speed_mps - desired_speed_mps;
    let acceleration = body.acceleration(state.turn_rate_rad_s);
    Lie {
        value: error * error,
        lf: 2.0 * error * acceleration.drift,
        lg: [2.0 * error * acceleration.control[0], 0.0],
    }
}

/// `V2 = ω²`
#[must_use]
pub fn turn_rate(body: &Body, state: &State) -> Lie {
    let turn = state.turn_rate_rad_s;
    Lie {
        value: turn * turn,
        lf: 0.0,
        lg: [0.0, 2.0 * turn / body.inertia_kgm2],
    }
}

/// `V3 = √3 ρ² + 2 ρ ρ̇ + √3 (ρ̇² + ρ² φ̇²)`: the quadratic form of `η3 = ρ e_r` and `η̇3` whose matrix solves the Riccati
/// equation for `Q = R = I`. A convergence rate up to `1/(1 + √3)` is guaranteed. It is blind to the direction of travel.
#[must_use]
pub fn tracking(lateral: &Lateral) -> Lie {
    let Lateral {
        deviation_m: rho,
        rate_mps: rho_rate,
        acceleration,
        frame_rate_rad_s: phi_rate,
        frame_acceleration,
    } = *lateral;
    let by_acceleration = 2.0 * (rho + SQRT_3 * rho_rate);
    let by_frame = 2.0 * SQRT_3 * rho * rho * phi_rate;
    let drift = 2.0 * rho_rate * (SQRT_3 * rho + rho_rate + SQRT_3 * rho * phi_rate * phi_rate);
    let change = acceleration.combined(by_acceleration, frame_acceleration, by_frame, drift);
    Lie {
        value: SQRT_3 * (rho * rho + rho_rate * rho_rate + rho * rho * phi_rate * phi_rate)
            + 2.0 * rho * rho_rate,
        lf: change.drift,
        lg: change.control,
    }
}
