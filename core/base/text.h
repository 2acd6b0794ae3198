/// Texts that come from outside (file names, scenes, the environment, libraries) made safe for where they go.
///
/// A name on Linux is any bytes but '/' and NUL: it need not be UTF-8, and may hold what a terminal obeys.
#pragma once

#include <string>
#include <string_view>

namespace raypool {

/// The text as UTF-8, for files: each byte that is not part of a valid character becomes U+FFFD. Text that is valid
/// comes back as it is.
std::string valid_utf8(std::string_view text);

/// The text for a terminal, on one line: control characters (of ASCII and of Latin-1), line and paragraph separators
/// and what changes the direction of writing become escapes such as \x1b or \u202e, and so does each byte that is not
/// part of a valid character (\xff). All else, a backslash too, comes back as it is.
std::string printable(std::string_view text);

/// The text as one word of a shell's command, which is printable too: as it is where that is plain, else quoted, as
/// $'bad\xff' (bash, zsh, POSIX 2024) where it holds what printable() escapes.
std::string shell_word(std::string_view text);

}  // namespace raypool
