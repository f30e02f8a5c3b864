// What is made of the tables of keys: the reference page docs/keys.md, the JSON Schema docs/scene.schema.json and the answers of `openclose explain`.
// A test says whether the two files are up to date; `openclose explain --page` and `--schema` print them anew.
#pragma once

#include <string>
#include <vector>

#include "openclose/scene/keys.h"

namespace openclose {

/// The words that a key accepts, those of registries included; empty if it accepts something else.
std::vector<std::string> accepted_words(const KeyEntry& entry);

/// Markdown: every key with unit, default, what is accepted and what it does.
std::string keys_page();

/// JSON Schema (draft 2020-12) of a scene file, for editors that know TOML: types, ranges, words and keys that there are.
std::string scene_schema();

/// The tables of a scene with what each is about, a line each.
std::string tables_in_words();

/// What the page tells about one key, or about each key of a table, in lines for a terminal. The key may be dotted or only its name.
/// Throws InputError for a key that is not known.
std::string explanation_of(const std::string& key);

}  // namespace openclose
