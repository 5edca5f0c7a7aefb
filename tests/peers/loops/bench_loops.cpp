// Pinocchio's forward dynamics of trees with loops and couplings, in the protocol of program/src/main.rs:
//   lcaba         loop-constrained articulated bodies, with the regularisation and iterations below
//   proximal      constraintDynamics: Cholesky of mass matrix and constraints, the same
//   multipliers   forwardDynamics with the constraints' dense Jacobian, for couplings of coordinates, which the others do not have
//   aba           articulated bodies, where there are no constraints
#include <pinocchio/fwd.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/contact-dynamics.hpp>
#include <pinocchio/algorithm/loop-constrained-aba.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include "../src/common.hpp"
#include "../src/pin_model.hpp"
using namespace pinocchio;
#ifndef FLAGS
#define FLAGS "?"
#endif

// What ProximalSettings has. A loop in a plane says nothing across it, so that the equations are singular without mu. README.md tells what other settings do.
static double setting(const char* name, double otherwise) { const char* given = std::getenv(name); return given ? std::atof(given) : otherwise; }

struct Loops : Bench {
  Model model;
  std::unique_ptr<Data> data, other;
  std::vector<Eigen::VectorXd> Q, V, T;
  std::vector<RigidConstraintModel> constraints;
  std::vector<RigidConstraintData> work, more;
  Eigen::MatrixXd J;
  Eigen::VectorXd gamma;
  ProximalSettings lcaba_settings{1e-14, setting("LCABA_MU", 1e-4), (int)setting("LCABA_ITERATIONS", 3)};
  ProximalSettings proximal_settings{1e-14, setting("PROXIMAL_MU", 1e-8), (int)setting("PROXIMAL_ITERATIONS", 2)};
  std::string info() override {
    char settings[200];
    std::snprintf(settings, 200, ", lcaba mu %g, at most %d iterations, proximal mu %g, %d", lcaba_settings.mu, lcaba_settings.max_iter, proximal_settings.mu, proximal_settings.max_iter);
    return std::string("pinocchio ") + PINOCCHIO_VERSION + ", " + FLAGS + settings;
  }
  static std::vector<double> vec(const Eigen::VectorXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); }
  // Lines that the model alone does not have.
  void read(const std::string& path) {
    std::ifstream f(path);
    std::string line, word;
    std::vector<std::map<int, double>> couplings;
    while (std::getline(f, line)) {
      std::istringstream words(line);
      words >> word;
      if (word == "armature") {
        int joint; double x;
        words >> joint >> x;
        model.armature[model.joints[joint].idx_v()] = x;
      } else if (word == "loop") {
        int i, j; Eigen::Vector3d a, b;
        words >> i >> a[0] >> a[1] >> a[2] >> j >> b[0] >> b[1] >> b[2];
        SE3 first(Eigen::Matrix3d::Identity(), a), second(Eigen::Matrix3d::Identity(), b);
        constraints.emplace_back(CONTACT_3D, model, i, first, j, second, LOCAL);
      } else if (word == "coupling") {
        int n; words >> n;
        couplings.emplace_back();
        for (; n > 0; n--) { int joint; double x; words >> joint >> x; couplings.back()[joint] = x; }
      }
    }
    J = Eigen::MatrixXd::Zero(couplings.size(), model.nv);
    gamma = Eigen::VectorXd::Zero(couplings.size());
    for (size_t k = 0; k < couplings.size(); k++)
      for (auto& [joint, x] : couplings[k]) J(k, model.joints[joint].idx_v()) = x;
  }
  void load(std::istringstream& words) override {
    std::string folder, name;
    words >> folder >> name;
    m = read_model(folder + "/" + name + ".txt");
    s = read_states(folder + "/" + name + ".bin", m.nq, m.nv);
    build_pin_model(m, model);
    read(folder + "/" + name + ".txt");
    setup();
  }
  void setup() override {
    data.reset(new Data(model));
    other.reset(new Data(model));
    Data& d = *data;
    for (auto& c : constraints) { work.emplace_back(c); more.emplace_back(c); }
    for (int k = 0; k < s.n; k++) {
      Q.push_back(Eigen::Map<const Eigen::VectorXd>(s.q(k), m.nq));
      V.push_back(Eigen::Map<const Eigen::VectorXd>(s.v(k), m.nv));
      T.push_back(Eigen::Map<const Eigen::VectorXd>(s.tau(k), m.nv));
    }
    if (!constraints.empty()) {
      computeJointMinimalOrdering(model, d, constraints);
      initConstraintDynamics(model, *other, constraints, more);
      auto first = [&, this](int k) { lcaba(model, d, Q[k], V[k], T[k], constraints, work, lcaba_settings); };
      auto second = [&, this](int k) { constraintDynamics(model, *other, Q[k], V[k], T[k], constraints, more, proximal_settings); };
      add("lcaba", first, [=, this](int k) { first(k); return vec(data->ddq); });
      add("proximal", second, [=, this](int k) { second(k); return vec(other->ddq); });
    } else if (J.rows() > 0) {
      auto f = [&, this](int k) { forwardDynamics(model, d, Q[k], V[k], T[k], J, gamma, 0.0); };
      add("multipliers", f, [=, this](int k) { f(k); return vec(data->ddq); });
    } else {
      auto f = [&, this](int k) { aba(model, d, Q[k], V[k], T[k], Convention::LOCAL); };
      add("aba", f, [=, this](int k) { f(k); return vec(data->ddq); });
    }
  }
};

int main() { return bench_main<Loops>(); }
