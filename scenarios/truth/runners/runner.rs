// Reads the problems, and says how far the motions of an engine are from the exact ones. No dependency.
use std::process::exit;

pub struct Problem(String);

impl Problem {
    /// The number of this name, or its list, row by row.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        let start = match self.0.find(&format!("\"{}\":", name)) {
            Some(place) => place + name.len() + 3,
            None => return Vec::new(),
        };
        let (mut depth, mut end) = (0, start);
        for character in self.0[start..].chars() {
            match character {
                '[' => depth += 1,
                ']' => depth -= 1,
                ',' | '\n' if depth == 0 => break,
                _ => {}
            }
            end += character.len_utf8();
        }
        let text = self.0[start..end].replace(&['[', ']', '\n', ' '][..], "");
        text.split(',').filter_map(|number| number.parse().ok()).collect()
    }

    pub fn number(&self, name: &str) -> f64 {
        self.numbers(name)[0]
    }
}

/// What an engine calls with time, positions and velocities after every step, the first time before the first one;
/// false: the motion may end.
pub type Row<'a> = dyn FnMut(f64, &[f64], &[f64]) -> bool + 'a;

/// The largest error over what is allowed, of positions and velocities at the times of a problem.
pub fn judge(problem: &Problem, engine: fn(&Problem, &mut Row)) -> f64 {
    let times = problem.numbers("times");
    let exact = [problem.numbers("positions"), problem.numbers("velocities")];
    let error = [problem.numbers("position_error"), problem.numbers("velocity_error")];
    let unsure = [problem.number("position_uncertainty"), problem.number("velocity_uncertainty")];
    let half = problem.number("time_step") / 2.0;
    let (mut worst, mut row) = (0.0_f64, 0);
    engine(problem, &mut |time, positions, velocities| {
        if time < times[row] - half {
            return true;
        }
        for (kind, own) in [positions, velocities].iter().enumerate() {
            for (body, allowed) in error[kind].iter().enumerate() {
                let off = (own[body] - exact[kind][row * error[kind].len() + body]).abs();
                let part = off / (allowed + unsure[kind]);
                worst = if part.is_nan() { f64::INFINITY } else { worst.max(part) };
            }
        }
        row += 1;
        row < times.len()
    });
    if row < times.len() { f64::INFINITY } else { worst }
}

/// Judges the motions of an engine; exit code 0 if all pass, 1 if one does not, 2 for another file.
pub fn run(engine: fn(&Problem, &mut Row)) -> ! {
    let mut code = 0;
    for file in std::env::args().skip(1) {
        let problem = Problem(std::fs::read_to_string(&file).unwrap_or_default());
        if problem.numbers("format") != [1.0] {
            eprintln!("{} is no problem of format 1", file);
            exit(2);
        }
        let part = judge(&problem, engine);
        let passes = part <= 1.0;
        println!("{} {}: {:.3} of what is allowed", if passes { "ok    " } else { "FAILED" }, file, part);
        code = if passes { code } else { 1 };
    }
    exit(code)
}
