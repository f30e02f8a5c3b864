// `dem`: springs of the joints and central difference. Its steps are taken by the loop of central_difference.h.
#include "openclose/integrator/registry.h"

namespace openclose {
namespace {

class Dem : public Enforcement {
 public:
  ContactSprings springs(const StepProblem& problem, const Contact& contact) const override { return joint_springs(problem, contact); }

  void solve(const StepProblem& problem, StepSolution& solution) override {
    solution.d = Eigen::VectorXd::Zero(dofs * problem.system.free_count());
    solution.reason = "method.contact = \"dem\" has no static steps";
  }

  std::unique_ptr<TimeScheme> make_time_scheme(const MethodInput& method) const override {
    refuse_integrators(method);
    const auto refuse = [&](const char* key, const char* value) {
      throw InputError(method.contact_where, key, std::string(value) + " has no meaning for method.contact = \"dem\"", "the default");
    };
    if (method.statics) refuse("method.statics", "true");
    if (method.rotation != RotationKind::exact) refuse("method.rotation", "\"linear\"");
    return make_central_difference_scheme();
  }
  bool is_explicit() const override { return true; }
  bool has_joint_springs() const override { return true; }
};

}  // namespace

std::unique_ptr<Enforcement> make_dem() {
  return std::make_unique<Dem>();
}

}  // namespace openclose
