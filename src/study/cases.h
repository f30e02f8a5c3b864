// Many runs of one scene, several at a time, each a process and a folder of its own. What has been done is not done again: a folder with a mark of
// the same scene (as read, with these overrides) and version is taken as it is.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace openclose {

struct Case {
  std::string name;                    ///< of its folder
  std::vector<std::string> overrides;  ///< "KEY=VALUE"
};

/// What has come of a case.
struct CaseResult {
  int status = 0;          ///< exit status of its command; 128 and a signal's number if one ended it
  std::string message;     ///< its last line on standard error, if it failed
  std::string summary;     ///< the text of summary.json; empty if there is none
  bool was_there = false;  ///< from an earlier time
};

struct CaseOrder {
  std::string program;  ///< path of openclose
  std::string command;  ///< "run" or "fos"
  std::string scene_file;
  std::string folder;  ///< with a folder a case
  int jobs = 1;        ///< processes at a time
  /// Called some hundred times a second while cases run; may throw Stopped.
  std::function<void()> interruption = [] {};
};

/// What the runs of cases warn of, one after the other. Of warnings that differ in their numbers only the first is told, with the number of the
/// others.
class CaseWarnings {
 public:
  /// \param summary  as in CaseResult
  void add(const std::string& name, const std::string& summary);
  void note(const std::string& name, const std::string& text);
  std::vector<std::string> texts() const;

 private:
  struct Kind {
    std::string pattern;  ///< the text without its numbers
    std::string first;
    int others = 0;  ///< cases
  };
  static std::string pattern_of(const std::string& text);
  std::vector<Kind> kinds_;
};

/// Throws InputError, before anything is written, if one of the scenes is refused, or if the folder of a case has files of somebody else. However it
/// ends, no case goes on running; after Stopped those that have ended need not run again.
/// \param done  called after each case, with its number
std::vector<CaseResult> run_cases(const CaseOrder& order, const std::vector<Case>& cases,
                                  const std::function<void(std::size_t, const CaseResult&)>& done);

/// Throws InputError if one of these "KEY=VALUE" sets a key that has values of its own in every case.
void require_not_set(const std::vector<std::string>& overrides, const std::string& key, const std::string& option);

/// Path of the program that runs now.
std::string this_program();

/// "success", "not converged", "bad input", "broken off".
std::string status_word(int status);

/// A name for a folder: what of these assignments can stand in the name of a file.
std::string folder_name(const std::vector<std::string>& overrides);

}  // namespace openclose
