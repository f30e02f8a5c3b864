// `soft`, the paper's DDA-SC: the springs are the joint's own stiffness; penetration is the joint's closure and is not constrained.
#include "openclose/integrator/newton.h"
#include "openclose/integrator/registry.h"

namespace openclose {
namespace {

template <int N>
class Soft final : public Enforcement<N> {
 public:
  ContactSprings springs(const StepProblem<N>& problem, const Contact& contact) const override {
    ContactSprings s = joint_springs(problem, contact);
    add_dashpots(problem, contact, s);
    return s;
  }

  StepSolution<N> solve(const StepProblem<N>& problem) override {
    springs_.resize(problem.contacts.size());
    for (std::size_t c = 0; c < springs_.size(); ++c) springs_[c] = springs(problem, problem.contacts[c]);
    StepSolution<N> solution;
    solution.d = drift(problem);
    newton_.solve(problem, springs_, solution);
    return solution;
  }

  std::unique_ptr<TimeScheme<N>> make_time_scheme(const MethodInput& method) const override { return make_theta_scheme<N>(method.theta); }
  const LinearCounters& linear_counters() const override { return newton_.linear_counters(); }
  void exchange(Archive& archive) override { newton_.exchange(archive); }

 private:
  Newton<N> newton_;
  std::vector<ContactSprings> springs_;
};

}  // namespace

template <int N>
std::unique_ptr<Enforcement<N>> make_soft() {
  return std::make_unique<Soft<N>>();
}

template std::unique_ptr<Enforcement<3>> make_soft<3>();

}  // namespace openclose
