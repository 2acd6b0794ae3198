/// What the command says, on the terminal or into a pipe: texts among the arguments are made printable, so that no file
/// name, scene or message can move the cursor or break a line.
#pragma once

#include <cstdio>
#include <string_view>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "core/base/text.h"

namespace raypool::cli {

namespace detail {

template <class T>
decltype(auto) shown(const T& value) {
    if constexpr (std::is_convertible_v<const T&, std::string_view>) {
        return printable(value);
    } else {
        return static_cast<const T&>(value);
    }
}
template <class T>
using Shown = decltype(shown(std::declval<const T&>()));

}  // namespace detail

template <class... Args>
void print(std::FILE* file, fmt::format_string<detail::Shown<Args>...> format, const Args&... args) {
    fmt::print(file, format, detail::shown(args)...);
}

/// To the standard output.
template <class... Args>
void print(fmt::format_string<detail::Shown<Args>...> format, const Args&... args) {
    fmt::print(stdout, format, detail::shown(args)...);
}

}  // namespace raypool::cli
