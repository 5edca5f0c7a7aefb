// Forward dynamics of generalized_rbda on its own URDF files, in the protocol of program/src/main.rs: `setState` and `forwardDynamics` of its
// `ClusterTreeModel<double>`. States are those of NAME.bin, found by the names of joints in NAME.json; accelerations are answered for all joints of the tree.
#include <grbda/Dynamics/ClusterTreeModel.h>
#include "../src/common.hpp"
using namespace grbda;
typedef DVec<double> Vector;

// The file of a mechanism that has one: `explicit_10_4`, `four_bars_5`, ...
static std::string urdf_of(const std::string& name) {
  std::istringstream words(name);
  std::vector<std::string> parts;
  for (std::string part; std::getline(words, part, '_');) parts.push_back(part);
  std::string folder = URDFS;
  if (parts[0] == "explicit" || parts[0] == "implicit")
    return folder + "/parallel_chains/" + (parts[0] == "explicit" ? "Explicit" : "Implicit") + "/depth" + parts[1] + "/loop_size" + parts[2] + ".urdf";
  if (parts[0] == "four") return folder + "/variable_four_bar_urdf/four_bar_branch_1_" + parts[2] + ".urdf";
  if (parts[0] == "rotors") return folder + "/variable_revolute_urdf/revolute_rotor_branch_1_" + parts[1] + ".urdf";
  throw std::runtime_error("generalized_rbda has no file of it");
}

// The list of strings behind `"joints": `.
static std::vector<std::string> names_of_joints(const std::string& path) {
  std::ifstream file(path);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  size_t at = text.find("\"joints\""), end = text.find(']', at);
  if (end == std::string::npos) throw std::runtime_error("no joints in " + path);
  std::vector<std::string> names;
  for (at = text.find('[', at); (at = text.find('"', at)) < end;) {
    size_t close = text.find('"', at + 1);
    names.push_back(text.substr(at + 1, close - at - 1));
    at = close + 1;
  }
  return names;
}

static Vector picked(const Vector& from, const std::vector<int>& places) {
  Vector out(places.size());
  for (size_t i = 0; i < places.size(); i++) out[i] = from[places[i]];
  return out;
}
// Of a free body's rates ours are linear, angular; theirs angular, linear.
static const std::vector<int> SWAPPED = {3, 4, 5, 0, 1, 2};

struct Rbda : Bench {
  std::unique_ptr<ClusterTreeModel<double>> model;
  std::vector<ModelState<double>> states;
  std::vector<Vector> efforts;
  std::vector<std::vector<int>> joints;  // of each cluster, by their place in the tree
  std::string info() override { return std::string(LIBRARY) + ", " + FLAGS; }

  void load(std::istringstream& words) override {
    std::string folder, name;
    words >> folder >> name;
    std::string urdf = urdf_of(name);
    if (!std::ifstream(urdf)) throw std::runtime_error("there is no " + urdf);
    m = read_model(folder + "/" + name + ".txt");
    s = read_states(folder + "/" + name + ".bin", m.nq, m.nv);
    model.reset(new ClusterTreeModel<double>(urdf));
    std::map<std::string, int> place;
    for (auto& joint : names_of_joints(folder + "/" + name + ".json")) place.insert({joint, (int)place.size()});
    for (auto& cluster : model->clusters()) {
      joints.emplace_back();
      for (auto& joint : cluster->joint_->singleJoints()) joints.back().push_back(place.at(joint->name()));
    }
    setup();
  }

  // Coordinates that a cluster takes as independent: rows of G that are those of the identity.
  static std::vector<int> independent(const DMat<double>& G) {
    std::vector<int> rows;
    for (int j = 0; j < G.cols(); j++)
      for (int i = 0; i < G.rows(); i++)
        if (G.row(i) == DMat<double>::Identity(G.cols(), G.cols()).row(j)) { rows.push_back(i); break; }
    if ((int)rows.size() != G.cols()) throw std::runtime_error("a cluster has no independent coordinates");
    return rows;
  }

  // Numbers of all joints of a cluster, of those that begin at `start(joint)`.
  Vector gather(int cluster, const double* from, int JointSpec::*start, int JointSpec::*size) const {
    std::vector<double> out;
    for (int joint : joints[cluster]) out.insert(out.end(), from + m.j[joint].*start, from + m.j[joint].*start + m.j[joint].*size);
    return Eigen::Map<Vector>(out.data(), out.size());
  }

  void add_state(int k) {
    ModelState<double> state;
    Vector tau(model->getNumDegreesOfFreedom());
    int at = 0;
    for (size_t c = 0; c < joints.size(); c++) {
      auto joint = model->clusters()[c]->joint_;
      Vector q = gather(c, s.q(k), &JointSpec::iq, &JointSpec::nq), v = gather(c, s.v(k), &JointSpec::iv, &JointSpec::nv);
      Vector effort = gather(c, s.tau(k), &JointSpec::iv, &JointSpec::nv);
      if (joint->type() == ClusterJointTypes::Free) {  // of its quaternion ours is x y z w, theirs w x y z
        q = picked(q, {0, 1, 2, 6, 3, 4, 5});
        v = picked(v, SWAPPED);
        effort = picked(effort, SWAPPED);
        state.emplace_back(JointCoordinate<double>(q, false), JointCoordinate<double>(v, false));
      } else {
        auto constraint = joint->cloneLoopConstraint();
        JointCoordinate<double> spanning(q, true);
        constraint->updateJacobians(spanning);
        auto rows = independent(constraint->G());
        state.emplace_back(constraint->isImplicit() ? spanning : JointCoordinate<double>(picked(q, rows), false), JointCoordinate<double>(picked(v, rows), false));
        effort = (constraint->G().transpose() * effort).eval();
      }
      tau.segment(at, effort.size()) = effort;
      at += effort.size();
    }
    states.push_back(state);
    efforts.push_back(tau);
  }

  std::vector<double> accelerations(int k) {
    model->setState(states[k]);
    Vector found = model->forwardDynamics(efforts[k]);
    std::vector<double> out(m.nv);
    int at = 0;
    for (size_t c = 0; c < joints.size(); c++) {
      auto joint = model->clusters()[c]->joint_;
      Vector own = found.segment(at, joint->numVelocities());
      at += own.size();
      if (joint->type() == ClusterJointTypes::Free) own = picked(own, SWAPPED);
      else own = (joint->G() * own + joint->g()).eval();
      int row = 0;
      for (int i : joints[c]) for (int n = 0; n < m.j[i].nv; n++) out[m.j[i].iv + n] = own[row++];
    }
    return out;
  }

  void setup() override {
    for (int k = 0; k < s.n; k++) add_state(k);
    auto f = [this](int k) { model->setState(states[k]); volatile double first = model->forwardDynamics(efforts[k])[0]; (void)first; };
    add("clusters", f, [this](int k) { return accelerations(k); });
  }
};

int main() { return bench_main<Rbda>(); }
