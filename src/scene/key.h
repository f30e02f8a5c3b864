// What a row in the tables of keys consists of. The rows themselves stand below the members that they name, in options.h and scene.h.
#pragma once

#include <string_view>

#include "openclose/scene/limits.h"

namespace openclose {

/// Whom a table is for. Developers measure and compare with theirs; every scene is served by the defaults.
enum class Audience { user, developer };

/// A table of the scene file, written [name].
struct KeyTable {
  std::string_view name;
  Audience audience = Audience::user;
  std::string_view says;  ///< what its keys are about
  bool many = false;      ///< written [[name]], as often as there are such things
};

/// A key of the scene file. Its default is what the member has before anything is read, its unit stands at the end of its name.
struct Key {
  std::string_view name;
  std::string_view says;               ///< what it does, in a sentence
  std::string_view absent{};           ///< what holds without it, where the member itself does not tell
  std::string_view formerly{};         ///< the dotted key that earlier versions had; still read, with a warning
  bool may_change_on_restart = false;  ///< the run that goes on from a checkpoint may have another value
  bool required = false;               ///< a table without it is refused
};

/// What a value may be, beside a Range and a list of words.
struct Flag {};
struct Increasing {
  Range each;
};
struct ListOf {
  Range each;
};
/// An angle in degrees, in radians inside.
struct Degrees {
  Range range;
};
/// The name of a block; the member is its number.
struct BlockName {};
/// A name that the user gives something; empty: none.
struct OwnName {};
/// What names a load, see increased_load.h.
struct LoadName {};
/// A name, or a list of names, in a registry that the scene does not know, because it stands downstream; who looks it up refuses an unknown one.
enum class NameIn { enforcements, integrators, formats };

}  // namespace openclose
