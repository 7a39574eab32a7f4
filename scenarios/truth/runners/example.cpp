// An engine of forty lines: the symplectic Euler scheme, with friction as impulses.
//   c++ -std=c++17 -O2 example.cpp -o example && ./example problems/*.json
#include "runner.hpp"

using truth::Numbers;

namespace {

std::vector<size_t> indices(const Numbers& bodies, size_t base) {
  std::vector<size_t> found;
  for (double body : bodies) found.push_back(body < 0 ? base : size_t(body));
  return found;
}

void simulate(const truth::Problem& problem, const truth::Row& row) {
  const Numbers masses = problem("masses");
  const size_t n = masses.size();  // and the index of the base
  const auto s1 = indices(problem("spring_first"), n), s2 = indices(problem("spring_second"), n);
  const auto c1 = indices(problem("contact_first"), n), c2 = indices(problem("contact_second"), n);
  const auto pulled = indices(problem("force_body"), n);
  const Numbers k = problem("spring_stiffness"), c = problem("spring_damping");
  const Numbers mean = problem("force_mean"), wave = problem("force_amplitude");
  const Numbers n0 = problem("contact_normal_force"), n1 = problem("contact_normal_amplitude");
  const Numbers kinetic = problem("contact_kinetic"), still = problem("contact_static");
  const double h = problem("time_step")[0], omega = problem("angular_frequency")[0];
  const double base = problem("base_amplitude")[0];
  Numbers x = problem("start_position"), v = problem("start_velocity"), w(n + 1, 0.0), slip(c1.size());
  x.push_back(0), v.push_back(0);
  for (size_t i = 0; i < n; ++i) w[i] = 1 / masses[i];
  for (size_t i = 0; i < c1.size(); ++i) slip[i] = v[c1[i]] - v[c2[i]];
  for (long step = 0; row(double(step) * h, x, v); ++step) {
    const double phase = omega * double(step) * h, sine = std::sin(phase);
    Numbers force(n + 1, 0.0);
    x[n] = base * sine, v[n] = base * omega * std::cos(phase);
    for (size_t i = 0; i < s1.size(); ++i) {
      const double pull = k[i] * (x[s1[i]] - x[s2[i]]) + c[i] * (v[s1[i]] - v[s2[i]]);
      force[s1[i]] -= pull, force[s2[i]] += pull;
    }
    for (size_t i = 0; i < pulled.size(); ++i) force[pulled[i]] += mean[i] + sine * wave[i];
    v[n] = 0;  // contacts with the base are those with the ground: it stands still in these problems
    for (size_t i = 0; i < n; ++i) v[i] += h * force[i] * w[i];
    for (size_t i = 0; i < c1.size(); ++i) {
      const double normal = h * (n0[i] + sine * n1[i]);
      const double wanted = -(v[c1[i]] - v[c2[i]]) / (w[c1[i]] + w[c2[i]]);  // would stop the contact
      const bool held = std::fabs(wanted) <= (slip[i] == 0 ? still[i] : kinetic[i]) * normal;
      const double impulse = held ? wanted : std::copysign(kinetic[i] * normal, wanted);
      v[c1[i]] += w[c1[i]] * impulse, v[c2[i]] -= w[c2[i]] * impulse;
      slip[i] = held ? 0 : v[c1[i]] - v[c2[i]];
    }
    for (size_t i = 0; i < n; ++i) x[i] += h * v[i];
  }
}

}  // namespace

int main(int count, char** files) { return truth::run(count, files, simulate); }
