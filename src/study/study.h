// The convergence of a scene of one's own: a quantity against the time step and its cost, for several methods.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "openclose/io/text_files.h"
#include "openclose/study/cases.h"

namespace openclose {

struct StudyOrder {
  CaseOrder cases;
  std::vector<std::string> overrides;  ///< of all cases
  std::vector<double> steps;           ///< [s]
  std::vector<std::string> contacts;   ///< values of method.contact; empty: the scene's own
  std::string quantity;                ///< empty: usual_quantity()
  std::optional<double> reference;     ///< exact value, if it is known
};

struct StudyRow {
  std::string contact;
  double dt = 0.0;  ///< [s]
  std::optional<double> value, error, order;
  double cpu = 0.0;  ///< [s] of start and motion
  long steps = 0;
  double end_time = 0.0;                  ///< [s]
  std::optional<double> integrator_loss;  ///< [-] see EnergyLedger; none where the summary does not tell
  int warnings = 0;                       ///< of the run
  int status = 0;
  std::string message;
};

/// What the errors of a method are measured against.
struct StudyLimit {
  std::string contact;
  std::optional<double> value;
  std::string how;
};

struct Study {
  std::string scene;  ///< its title, or its file
  std::string quantity;
  std::vector<StudyRow> rows;  ///< by method, the largest step first
  std::vector<StudyLimit> limits;
  std::vector<std::string> warnings;
};

/// Runs what has not been run yet. Throws InputError before anything is written.
Study make_study(StudyOrder order, const std::function<void(double fraction)>& progress);

/// study.csv, and study.svg where there is an error to draw.
std::vector<TextFile> study_files(const Study& study, const std::string& folder);

/// The table that is printed.
std::string study_table(const Study& study);

}  // namespace openclose
