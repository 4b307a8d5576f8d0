//! Transcendental functions that give the same bits on every platform (through `libm`), and rotations built on them.

use glam::DVec2;

/// Sine of `angle`, in radians.
pub fn sin(angle: f64) -> f64 {
    libm::sin(angle)
}

/// Cosine of `angle`, in radians.
pub fn cos(angle: f64) -> f64 {
    libm::cos(angle)
}

/// Arc cosine in radians; the argument is clamped to -1..=1.
pub fn acos(x: f64) -> f64 {
    libm::acos(x.clamp(-1.0, 1.0))
}

/// `x` to the power `y`.
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// e to the power `x`.
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Natural logarithm.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// Unit vector at `angle` radians from east, counter-clockwise.
pub fn direction(angle: f64) -> DVec2 {
    DVec2::new(cos(angle), sin(angle))
}

/// Angle of `v` from east in radians, -pi..=pi.
pub fn angle_of(v: DVec2) -> f64 {
    libm::atan2(v.y, v.x)
}

/// A number that grows with the angle of `v` from east, counter-clockwise, for sorting by angle without trigonometry: 0 for
/// east, 1 for north, less than 4, and within 0.05 of the angle in quarter turns.
pub fn quarters(v: DVec2) -> f64 {
    let share = v.x / (v.x.abs() + v.y.abs()).max(f64::MIN_POSITIVE);
    if v.y < 0.0 { 3.0 + share } else { 1.0 - share }
}

/// `v` turned counter-clockwise by `angle` radians.
pub fn rotate(v: DVec2, angle: f64) -> DVec2 {
    direction(angle).rotate(v)
}

/// Unsigned angle between two directions, 0..=pi.
pub fn angle_between(a: DVec2, b: DVec2) -> f64 {
    libm::fabs(libm::atan2(a.perp_dot(b), a.dot(b)))
}

/// Signed angle from `a` to `b`, counter-clockwise positive, -pi..=pi.
pub fn turn(a: DVec2, b: DVec2) -> f64 {
    libm::atan2(a.perp_dot(b), a.dot(b))
}

/// Hermite step: 0 at and below `low`, 1 at and above `high`.
pub fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Linear interpolation: `a` at `t` = 0, `b` at 1.
pub fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_grow_with_the_angle() {
        let mut last = -1.0;
        for step in 0..4000 {
            let angle = f64::from(step) * std::f64::consts::TAU / 4000.0;
            let quarters = quarters(direction(angle) * f64::from(1 + step % 7));
            assert!(quarters > last && quarters < 4.0 && (quarters - f64::from(step) / 1000.0).abs() < 0.05, "{step}");
            last = quarters;
        }
        assert_eq!([DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y].map(quarters), [0.0, 1.0, 2.0, 3.0]);
    }
}
