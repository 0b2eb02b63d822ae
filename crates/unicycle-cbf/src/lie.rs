//! Functions of the state with their Lie derivatives along `ẋ = f(x) + g(x) u`.

/// A function `F` of the state with `Ḟ = L_f F + L_g F · u`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lie {
    /// `F`
    pub value: f64,
    /// `L_f F`, in units of `F` per s
    pub lf: f64,
    /// `L_g F`, by force and by torque
    pub lg: [f64; 2],
}

impl Lie {
    /// `Ḟ` for given inputs `[u_l, u_a]`.
    #[must_use]
    pub fn rate(&self, input: [f64; 2]) -> f64 {
        self.lf + self.lg[0] * input[0] + self.lg[1] * input[1]
    }
}
