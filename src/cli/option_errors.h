// What is said of a command line that cannot be read: the option that may be meant, and the words that an option accepts.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace openclose {

/// For CLI::Option::check(): a word of the list; another one is refused with the one that may be meant.
CLI::Validator one_of(const std::vector<std::string>& words);

/// For CLI::Option::check(): numbers that options of type double may have; "nan" is one of them, and in every range.
CLI::Validator finite_number();

/// One line: what is wrong, what is accepted, and which help tells more.
std::string words_of(const CLI::ParseError& error, const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace openclose
