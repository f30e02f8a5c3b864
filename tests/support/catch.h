// Catch2 of either version, in the spelling of version 3: Approx, TEST_CASE, CHECK_THAT(text, ContainsSubstring("...")), ...
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>
namespace Catch::Matchers {
/// Version 2 calls it Contains, a name that version 3 gives to something else.
inline StdString::ContainsMatcher ContainsSubstring(const std::string& text) { return Contains(text); }
}  // namespace Catch::Matchers
#endif
