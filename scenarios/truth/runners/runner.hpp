// Reads the problems, and says how far the motions of an engine are from the exact ones. C++17, no dependency.
#pragma once
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

namespace truth {

using Numbers = std::vector<double>;

struct Problem {
  std::string text;

  // The number of this name, or its list, row by row.
  Numbers operator()(const std::string& name) const {
    Numbers numbers;
    const size_t place = text.find("\"" + name + "\":");
    if (place == std::string::npos) return numbers;
    int depth = 0;
    for (const char* at = text.c_str() + place + name.size() + 3; *at; ++at) {
      depth += (*at == '[') - (*at == ']');
      char* end = nullptr;
      const double number = std::strtod(at, &end);
      if (end != at) numbers.push_back(number), at = end - 1;
      if (depth == 0 && (end != at || *at == ']') && (*at == ']' || !numbers.empty())) break;
    }
    return numbers;
  }
};

// What an engine calls after every step, the first time before the first one; false: the motion may end.
using Row = std::function<bool(double time, const Numbers& positions, const Numbers& velocities)>;
using Engine = std::function<void(const Problem&, const Row&)>;

// The largest error over what is allowed, of positions and velocities at the times of a problem.
inline double judge(const Problem& problem, const Engine& engine) {
  const Numbers times = problem("times"), exact[] = {problem("positions"), problem("velocities")};
  const Numbers error[] = {problem("position_error"), problem("velocity_error")};
  const Numbers unsure[] = {problem("position_uncertainty"), problem("velocity_uncertainty")};
  const double half = problem("time_step")[0] / 2;
  double worst = 0;
  size_t row = 0;
  engine(problem, [&](double time, const Numbers& positions, const Numbers& velocities) {
    if (time < times[row] - half) return true;
    for (int kind = 0; kind < 2; ++kind)
      for (size_t body = 0; body < error[kind].size(); ++body) {
        const double truth = exact[kind][row * error[kind].size() + body];
        const double off = std::fabs((kind ? velocities : positions)[body] - truth);
        const double part = off / (error[kind][body] + unsure[kind][0]);
        worst = std::isnan(part) ? INFINITY : std::fmax(worst, part);
      }
    return ++row < times.size();
  });
  return row < times.size() ? INFINITY : worst;
}

// Judges the motions of an engine; gives the exit code: 0 if all pass, 1 if one does not, 2 for another file.
inline int run(int count, char** files, const Engine& engine) {
  int code = 0;
  for (int i = 1; i < count; ++i) {
    std::ifstream file(files[i]);
    const Problem problem{{std::istreambuf_iterator<char>(file), {}}};
    if (problem("format") != Numbers{1}) return std::fprintf(stderr, "%s is no problem of format 1\n", files[i]), 2;
    const double part = judge(problem, engine);
    if (!(part <= 1)) code = 1;
    std::printf("%s %s: %.3f of what is allowed\n", part <= 1 ? "ok    " : "FAILED", files[i], part);
  }
  return code;
}

}  // namespace truth
