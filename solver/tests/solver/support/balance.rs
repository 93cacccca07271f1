//! Harmonic balance from physical matrices and the definitions of the laws, by dense sampling in time: nothing of the
//! solver's formulations is used, only what a model is made of and the harmonics of a state.

use solver::laws::{LawKind, Term};
use solver::{Matrix, Model, State};
use std::f64::consts::TAU;

/// Instants a period.
const SAMPLES: usize = 4096;

/// Matrices of the equation of motion M ẍ + C ẋ + K x + f = A s cos(mωt), n × n.
pub struct Matrices {
    pub mass: Matrix,
    pub damping: Matrix,
    pub stiffness: Matrix,
}

impl Matrices {
    /// Those of a model; C = M Φ Ĉ Φᵀ M, as modes are mass-normalised.
    pub fn of(model: &Model) -> Self {
        let left = model.mass().matmul(&model.modes().shapes);
        let damping = left.matmul(&model.damping().matrix()).matmul(&left.transpose());
        Self { mass: model.mass().clone(), damping, stiffness: model.stiffness().clone() }
    }
}

/// How well a state fulfils the balance.
#[derive(Debug, Clone, Copy)]
pub struct Residual {
    /// Largest force left over in any harmonic of any dof, N.
    pub left: f64,
    /// Largest single term (inertia, damping, stiffness, a law, forcing) in any harmonic of any dof, N.
    pub term: f64,
    /// Largest entry of the forcing A s, N.
    pub forcing: f64,
}

impl Residual {
    /// What is left over, of the largest term.
    pub fn relative(&self) -> f64 {
        self.left / self.term
    }
}

/// Values of cos and sin at all instants.
struct Circle(Vec<(f64, f64)>);

impl Circle {
    fn new() -> Self {
        let angle = |n: usize| TAU * n as f64 / SAMPLES as f64;
        Self((0..SAMPLES).map(|n| (angle(n).cos(), angle(n).sin())).collect())
    }

    /// Displacement and velocity at all instants.
    fn motion(&self, series: &[f64], omega: f64) -> (Vec<f64>, Vec<f64>) {
        let instant = |n: usize| {
            let harmonics = (1..=series.len() / 2).map(|k| {
                let (cosine, sine) = self.0[k * n % SAMPLES];
                let (a, b) = (series[2 * k - 1], series[2 * k]);
                (a * cosine + b * sine, k as f64 * omega * (b * cosine - a * sine))
            });
            harmonics.fold((series[0], 0.0), |sum, term| (sum.0 + term.0, sum.1 + term.1))
        };
        (0..SAMPLES).map(instant).unzip()
    }

    /// Harmonics of a signal, `width` numbers.
    fn series(&self, signal: &[f64], width: usize) -> Vec<f64> {
        let mut series = vec![0.0; width];
        for (n, value) in signal.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            series[0] += value / SAMPLES as f64;
            for k in 1..=width / 2 {
                let (cosine, sine) = self.0[k * n % SAMPLES];
                series[2 * k - 1] += 2.0 * value * cosine / SAMPLES as f64;
                series[2 * k] += 2.0 * value * sine / SAMPLES as f64;
            }
        }
        series
    }
}

/// max(0, signal), of which a sum over instants gives integrals to third order in the time between them: at a kink of
/// slope J after a share s of an interval h the sum exceeds the integral by h² J (s(1 − s) − 1/6)/2 (Euler and Maclaurin).
fn rectified(signal: &[f64]) -> Vec<f64> {
    let mut positive: Vec<f64> = signal.iter().map(|p| p.max(0.0)).collect();
    for n in 0..signal.len() {
        let next = (n + 1) % signal.len();
        let (from, to) = (signal[n], signal[next]);
        if (from > 0.0) != (to > 0.0) {
            let share = from / (from - to);
            let excess = 0.5 * (to - from).abs() * (share * (1.0 - share) - 1.0 / 6.0);
            positive[n] -= (1.0 - share) * excess;
            positive[next] -= share * excess;
        }
    }
    positive
}

fn polynomial(terms: &[Term], z: f64) -> f64 {
    terms.iter().map(|term| term.coefficient * z.powi(term.power as i32)).sum()
}

/// Force of a law without memory of one argument, at displacement `u` and velocity `v`; `None` for other laws.
pub fn scalar_force(law: &LawKind, u: f64, v: f64) -> Option<f64> {
    match law {
        LawKind::PolynomialSpring(spring) => Some(polynomial(&spring.terms, u)),
        LawKind::PolynomialDamper(damper) => Some(polynomial(&damper.terms, v)),
        LawKind::PenaltySpring(stop) => Some(stop.stiffness * (u - stop.gap).max(0.0)),
        LawKind::TanhFriction(friction) => Some(friction.limit * (v / friction.velocity).tanh()),
        LawKind::Jenkins(_) | LawKind::Contact(_) => None,
    }
}

/// Force of a spring of stiffness k in series with a slider that holds F, on the second turn of a periodic path from a
/// state without force at zero.
fn slider(stiffness: f64, limit: f64, path: &[f64]) -> Vec<f64> {
    let (mut at, mut force) = (0.0, 0.0f64);
    let mut turn = || {
        let step = |&u: &f64| {
            force = (force + stiffness * (u - at)).clamp(-limit, limit);
            at = u;
            force
        };
        path.iter().map(step).collect::<Vec<f64>>()
    };
    turn();
    turn()
}

/// The harmonic balance of a model.
pub struct Balance<'m> {
    model: &'m Model,
    matrices: Matrices,
    circle: Circle,
}

impl<'m> Balance<'m> {
    pub fn new(model: &'m Model) -> Self {
        Self { model, matrices: Matrices::of(model), circle: Circle::new() }
    }

    /// Harmonics of all displacements, n × (2H + 1), m.
    pub fn displacements(&self, state: &State) -> Vec<Vec<f64>> {
        (0..self.model.size()).map(|dof| state.displacement(self.model, dof)).collect()
    }

    /// What a forced response leaves of the balance. A rigid contact has its complementarity as an equation of its own:
    /// with λ = max(0, p), the harmonics of p are those of λ − ε g.
    pub fn residual(&self, state: &State) -> Residual {
        let x = self.displacements(state);
        let (n, width) = (x.len(), 2 * state.harmonics + 1);
        let mut left = vec![vec![0.0; width]; n];
        let mut term = 0.0f64;
        let mut add = |left: &mut Vec<Vec<f64>>, dof: usize, place: usize, force: f64| {
            left[dof][place] += force;
            term = term.max(force.abs());
        };
        for i in 0..n {
            for (j, x) in x.iter().enumerate() {
                let at = (i, j);
                let (m, c, k) = (self.matrices.mass[at], self.matrices.damping[at], self.matrices.stiffness[at]);
                add(&mut left, i, 0, k * x[0]);
                for harmonic in 1..=state.harmonics {
                    let rate = harmonic as f64 * state.omega;
                    let (cosine, sine) = (2 * harmonic - 1, 2 * harmonic);
                    for (place, other, sign) in [(cosine, sine, 1.0), (sine, cosine, -1.0)] {
                        add(&mut left, i, place, k * x[place]);
                        add(&mut left, i, place, -rate * rate * m * x[place]);
                        add(&mut left, i, place, sign * rate * c * x[other]);
                    }
                }
            }
        }
        let forcing = self.model.forcing();
        for (dof, shape) in forcing.shape.iter().enumerate() {
            add(&mut left, dof, 2 * forcing.harmonic - 1, -state.forcing * shape);
        }
        let mut contact = 0.0f64;
        for (first, element) in self.model.numbered() {
            let relative = |channel: &Vec<(usize, f64)>| -> Vec<f64> {
                (0..width).map(|place| channel.iter().map(|&(dof, b)| b * x[dof][place]).sum()).collect()
            };
            let arguments: Vec<Vec<f64>> = element.channels.iter().map(relative).collect();
            let forces = match &element.law {
                LawKind::Contact(law) => {
                    let predicted = &state.arguments[first * width..(first + 1) * width];
                    let pressure = rectified(&self.circle.motion(predicted, state.omega).0);
                    let held = self.circle.series(&pressure, width);
                    for place in 0..width {
                        let gap = if place == 0 { law.gap } else { 0.0 } - arguments[0][place];
                        contact = contact.max((predicted[place] - held[place] + law.epsilon * gap).abs());
                    }
                    let mut forces = vec![held];
                    if let Some(friction) = &law.friction {
                        let velocities = [1, 2].map(|j| self.circle.motion(&arguments[j], state.omega).1);
                        let speed = friction.sense * friction.radius * forcing.harmonic as f64 * state.omega;
                        for j in 0..2 {
                            let at = |instant: usize| {
                                let (v, w) = (velocities[0][instant] + speed, velocities[1][instant]);
                                friction.coefficient * pressure[instant] * [v, w][j] / v.hypot(w)
                            };
                            let signal: Vec<f64> = (0..SAMPLES).map(at).collect();
                            forces.push(self.circle.series(&signal, width));
                        }
                    }
                    forces
                }
                law => {
                    let (u, v) = self.circle.motion(&arguments[0], state.omega);
                    let signal = match law {
                        LawKind::Jenkins(law) => slider(law.stiffness, law.limit, &u),
                        LawKind::PenaltySpring(law) => {
                            let pressed: Vec<f64> = u.iter().map(|u| law.stiffness * (u - law.gap)).collect();
                            rectified(&pressed)
                        }
                        _ => u.iter().zip(&v).filter_map(|(&u, &v)| scalar_force(law, u, v)).collect(),
                    };
                    assert_eq!(signal.len(), SAMPLES, "{}: a law that this balance does not know", element.name);
                    vec![self.circle.series(&signal, width)]
                }
            };
            for (channel, force) in element.channels.iter().zip(&forces) {
                for &(dof, b) in channel {
                    (0..width).for_each(|place| add(&mut left, dof, place, b * force[place]));
                }
            }
        }
        let largest = left.iter().flatten().fold(contact, |m, force| m.max(force.abs()));
        let forcing = forcing.shape.iter().fold(0.0f64, |m, s| m.max((state.forcing * s).abs()));
        Residual { left: largest, term, forcing }
    }

    /// Whether no law with a gap acts, and no rigid contact: if there are no other laws, the response is the linear one.
    pub fn is_free(&self, state: &State) -> bool {
        let x = self.displacements(state);
        let width = 2 * state.harmonics + 1;
        self.model.elements().iter().all(|element| {
            let gap = match &element.law {
                LawKind::Contact(law) => law.gap,
                LawKind::PenaltySpring(law) => law.gap,
                _ => return false,
            };
            let series: Vec<f64> =
                (0..width).map(|place| element.channels[0].iter().map(|&(dof, b)| b * x[dof][place]).sum()).collect();
            self.circle.motion(&series, state.omega).0.iter().all(|&u| u < gap)
        })
    }
}
