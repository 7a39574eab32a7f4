// An engine of forty lines: the symplectic Euler scheme, with friction as impulses.
//   rustc -O example.rs && ./example problems/*.json
mod runner;
use runner::{Problem, Row};

fn simulate(problem: &Problem, row: &mut Row) {
    let of = |name: &str| problem.numbers(name);
    let masses = of("masses");
    let n = masses.len(); // and the index of the base
    let bodies = |name: &str| -> Vec<usize> {
        of(name).iter().map(|&body| if body < 0.0 { n } else { body as usize }).collect()
    };
    let (s1, s2, pulled) = (bodies("spring_first"), bodies("spring_second"), bodies("force_body"));
    let (c1, c2) = (bodies("contact_first"), bodies("contact_second"));
    let (k, c) = (of("spring_stiffness"), of("spring_damping"));
    let (mean, wave) = (of("force_mean"), of("force_amplitude"));
    let (n0, n1) = (of("contact_normal_force"), of("contact_normal_amplitude"));
    let (kinetic, still) = (of("contact_kinetic"), of("contact_static"));
    let (h, omega) = (problem.number("time_step"), problem.number("angular_frequency"));
    let base = problem.number("base_amplitude");
    let (mut x, mut v) = (of("start_position"), of("start_velocity"));
    x.push(0.0);
    v.push(0.0);
    let mut w: Vec<f64> = masses.iter().map(|mass| 1.0 / mass).collect();
    w.push(0.0);
    let mut slip: Vec<f64> = (0..c1.len()).map(|i| v[c1[i]] - v[c2[i]]).collect();
    let mut step = 0;
    while row(step as f64 * h, &x, &v) {
        let phase = omega * step as f64 * h;
        let mut force = vec![0.0; n + 1];
        x[n] = base * phase.sin();
        v[n] = base * omega * phase.cos();
        for i in 0..s1.len() {
            let pull = k[i] * (x[s1[i]] - x[s2[i]]) + c[i] * (v[s1[i]] - v[s2[i]]);
            force[s1[i]] -= pull;
            force[s2[i]] += pull;
        }
        for i in 0..pulled.len() {
            force[pulled[i]] += mean[i] + phase.sin() * wave[i];
        }
        v[n] = 0.0; // contacts with the base are those with the ground: it stands still in these problems
        for i in 0..n {
            v[i] += h * force[i] * w[i];
        }
        for i in 0..c1.len() {
            let (a, b, normal) = (c1[i], c2[i], h * (n0[i] + phase.sin() * n1[i]));
            let wanted = -(v[a] - v[b]) / (w[a] + w[b]); // would stop the contact
            let held = wanted.abs() <= (if slip[i] == 0.0 { still[i] } else { kinetic[i] }) * normal;
            let impulse = if held { wanted } else { wanted.signum() * kinetic[i] * normal };
            v[a] += w[a] * impulse;
            v[b] -= w[b] * impulse;
            slip[i] = if held { 0.0 } else { v[a] - v[b] };
        }
        for i in 0..n {
            x[i] += h * v[i];
        }
        step += 1;
    }
}

fn main() {
    runner::run(simulate)
}
