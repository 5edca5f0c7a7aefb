// MuJoCo's own stepping, in a compiled loop: mj_step from the key frame of a scene.
//   load FILE.xml                     ->  ok child METHOD:steps ...      |  skip REASON
//   run METHOD STEPS T_END REPS MAX_S ->  ok SECONDS_LEAST SECONDS_MEDIAN REPETITIONS EVALUATIONS STEPS, then 18 numbers a body | fail REASON
// The numbers of bodies b0, b1, …: work.py tells them. Times are CPU times of this thread.
#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>
#include <time.h>
static double cpu() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}
struct Way {
  const char* name;
  int integrator, evaluations;
};
static const Way WAYS[] = {{"euler", mjINT_EULER, 1}, {"rk4", mjINT_RK4, 4}, {"implicit", mjINT_IMPLICIT, 1}, {"implicitfast", mjINT_IMPLICITFAST, 1}};
static mjModel* m = nullptr;
static mjData* d = nullptr;
static std::string load(const std::string& file) {
  if (d) mj_deleteData(d);
  if (m) mj_deleteModel(m);
  d = nullptr;
  char error[1000] = {0};
  m = mj_loadXML(file.c_str(), nullptr, error, 1000);
  if (!m) return std::string("skip ") + error;
  d = mj_makeData(m);
  std::string ways = "ok child";
  for (auto& way : WAYS) ways += std::string(" ") + way.name + ":steps";
  return ways;
}
static std::string state() {
  std::ostringstream out;
  out.precision(17);
  mj_forward(m, d);  // positions and velocities of bodies are those of the step before
  for (int i = 0; i < m->nbody - 1; i++) {
    int b = mj_name2id(m, mjOBJ_BODY, ("b" + std::to_string(i)).c_str());
    double v[6];
    mj_objectVelocity(m, d, mjOBJ_BODY, b, v, 0);  // angular, then linear of the centre of mass, world axes
    const double* R = d->xmat + 9 * b;
    for (int k = 0; k < 3; k++) out << ' ' << d->xipos[3 * b + k];
    for (int k = 0; k < 9; k++) out << ' ' << R[k];
    for (int k = 0; k < 3; k++) out << ' ' << v[3 + k];
    for (int k = 0; k < 3; k++) out << ' ' << R[k] * v[0] + R[3 + k] * v[1] + R[6 + k] * v[2];
  }
  return out.str();
}
static std::string run(const std::string& name, long steps, double t_end, int reps, double most) {
  const Way* way = nullptr;
  for (auto& known : WAYS)
    if (name == known.name) way = &known;
  if (!m || !way) return "fail no such method";
  m->opt.integrator = way->integrator;
  m->opt.timestep = t_end / steps;
  std::vector<double> seconds;
  double spent = 0;
  while ((int)seconds.size() < reps && (seconds.empty() || spent < most)) {
    mj_resetDataKeyframe(m, d, 0);
    double start = cpu();
    for (long k = 0; k < steps; k++) {
      mj_step(m, d);
      if (k % 1024 == 0 && cpu() - start > most) return "fail takes longer";
    }
    seconds.push_back(cpu() - start);
    spent += seconds.back();
  }
  std::sort(seconds.begin(), seconds.end());
  std::ostringstream out;
  out << "ok " << seconds[0] << ' ' << seconds[seconds.size() / 2] << ' ' << seconds.size() << ' ' << steps * way->evaluations << ' ' << steps << state();
  return out.str();
}
int main() {
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream in(line);
    std::string word, name;
    in >> word;
    if (word == "quit") break;
    if (word == "info") std::cout << "mujoco " << mj_versionString() << ", mj_step in C++, constraints and contacts switched off" << std::endl;
    else if (word == "load") { in >> name; std::cout << load(name) << std::endl; }
    else if (word == "run") {
      double steps, t_end, most;
      int reps;
      in >> name >> steps >> t_end >> reps >> most;
      std::cout << run(name, std::lround(steps), t_end, reps, most) << std::endl;
    } else std::cout << "fail unknown" << std::endl;
  }
}
