// What every verification case uses: checks with bounds from both sides, the methods a case runs with, and simulations that the whole regression can
// run with a solver that does nothing, to show that no check passes without one.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "openclose/analysis/run.h"
#include "registry.h"

namespace openclose::verification {

/// Sizes of series whose springs grow stiffer: 1/kn or k of one corner and metre of thickness.
inline constexpr const char* compliance_name = "compliance_m2_per_n";
inline constexpr const char* stiffness_name = "stiffness_n_per_m2";

enum class Status { pass, fail, left_out };

/// What a row is compared with, for the count at the end.
enum class Reference {
  closed_form,
  ode,             ///< integrated with its events located
  limit_analysis,  ///< a linear program
  conservation,    ///< of momentum, energy, areas
  invariance,      ///< under what must not matter
  ledger,          ///< of energies
  other_run,       ///< of the program itself, with another method or step
  last_value,      ///< what the program gave before
};
inline constexpr std::array reference_names = {"closed forms", "ODEs",    "linear programs",           "conservation",
                                               "invariance",   "ledgers", "other runs of the program", "last values"};

struct Check {
  std::string case_name;  ///< "B1"
  std::string quantity;
  std::string method;
  double expected = 0.0;
  double measured = 0.0;
  std::string unit;
  double error = 0.0;  ///< absolute or relative, as the source says
  double tolerance = 0.0;
  Status status = Status::fail;
  std::string source;  ///< where expected value and tolerance come from; for a check left out, why
  Reference reference = Reference::closed_form;
};

/// One point of a convergence series.
struct SeriesPoint {
  std::string case_name;
  std::string quantity;
  std::string method;
  std::string size_name;  ///< with its unit, "dt_s"
  double size = 0.0;
  double error = 0.0;
};

class Report {
 public:
  explicit Report(bool null_solver) : null_solver_(null_solver) {}

  /// \param reference  of the rows that do not say theirs
  void begin_case(const std::string& name, Reference reference = Reference::closed_form) {
    case_ = name;
    reference_of_case_ = reference_ = reference;
  }
  /// What the next row is compared with: `report.against(Reference::ode).order(...)`.
  Report& against(Reference reference) {
    reference_ = reference;
    return *this;
  }
  /// |measured - expected| <= tolerance.
  void near(const std::string& quantity, const std::string& method, double expected, double measured, double tolerance, const std::string& unit,
            const std::string& source);
  /// |measured/expected - 1| <= tolerance.
  void relative(const std::string& quantity, const std::string& method, double expected, double measured, double tolerance, const std::string& unit,
                const std::string& source);
  /// low <= measured <= high: expected is the middle, tolerance half the width.
  void between(const std::string& quantity, const std::string& method, double low, double high, double measured, const std::string& unit,
               const std::string& source);
  /// Convergence: least-squares slope of log(error) over log(size), bounded from both sides. The errors and their ratios from one refinement to the
  /// next go into the row's source, the points into series().
  void order(const std::string& quantity, const std::string& method, const std::vector<double>& sizes, const std::vector<double>& errors, double low,
             double high, const std::string& source, const std::string& size_name = "dt_s");
  void leave_out(const std::string& quantity, const std::string& method, const std::string& reason);

  /// A simulation with the scene's enforcement, or with one that does nothing.
  Simulation simulate(const Scene& scene) const;

  const std::vector<Check>& checks() const { return checks_; }
  const std::vector<SeriesPoint>& series() const { return series_; }
  bool null_solver() const { return null_solver_; }

 private:
  void add(const std::string& quantity, const std::string& method, double expected, double measured, double error, double tolerance,
           const std::string& unit, const std::string& source);

  bool null_solver_;
  std::string case_;
  Reference reference_of_case_ = Reference::closed_form, reference_ = Reference::closed_form;
  std::vector<Check> checks_;
  std::vector<SeriesPoint> series_;
};

/// Least-squares slope of log(y) over log(x); NaN if any value is not positive.
double log_slope(const std::vector<double>& x, const std::vector<double>& y);

/// Registers itself from its source in cases/.
struct Case {
  const char* name;  ///< "B1", its identifier
  const char* title;
  void (*run)(Report&);
  Reference reference = Reference::closed_form;  ///< of the rows that do not say theirs
};

/// Runs to the scene's end and hands out the motion of the first measured point (or first free block) at the output times.
/// Empty if the run does not get there.
struct Sample {
  double time;
  PointMotion motion;
};
std::vector<Sample> history(Simulation& simulation);

/// NaN, for a measurement whose conditions were not met.
double not_measured();

/// The larger of two; NaN if one of them is, which std::max() may swallow.
double larger(double a, double b);
/// The smaller of two; NaN if one of them is.
double smaller(double a, double b);
/// The largest of values that are not negative; NaN if one of them is NaN, which std::max_element() may skip.
double largest(const std::vector<double>& values);

/// How many rows passed against what: "12 closed forms, 3 ODEs".
std::string passed_by_reference(const std::vector<Check>& checks);

/// By how much a measurement exceeds a bound: 0 up to it, and NaN for NaN, which max() would turn into 0.
double exceedance(double measured, double bound);

std::string text(const char* format, double value);

}  // namespace openclose::verification
