// Values of the command line that replace values of the scene file.
#pragma once

#include <toml++/toml.h>

#include <string>

namespace openclose {

/// Applies KEY=VALUE to a parsed scene. KEY is dotted, with elements of arrays by index from 0: "joint[0].friction_angle_deg"; a table that the
/// file leaves out is made. VALUE is a TOML value; a single word that is none is taken as a text. The new nodes carry source_of_overrides() as
/// their source, so that later errors name the command line.
/// Throws InputError.
void apply_override(toml::table& scene, const std::string& file, const std::string& key_and_value);

/// KEY of KEY=VALUE, without the blanks behind it.
std::string key_of_override(const std::string& key_and_value);

/// In place of a file and a line where something of the scene file was given on the command line, by --set or by an option of its own.
std::string source_of_overrides(const std::string& file);

}  // namespace openclose
