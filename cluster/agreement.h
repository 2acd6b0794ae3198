/// What ranks tell each other before work begins: what each is about to do, or what keeps it from doing so. No
/// rank renders, writes or waits for the others before all have said the same.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cluster/ranks.h"
#include "core/film/checkpoint.h"

namespace raypool::cluster {

/// What one rank says.
struct Statement {
    int status = 0;     ///< with which it would exit; 0: it is ready
    std::string error;  ///< where it is not ready: why
    ImageKey terms;     ///< where it is: what it is about to do, by name

    bool operator==(const Statement&) const = default;
};

std::vector<std::byte> encoded(const Statement& statement);
Statement decoded(std::span<const std::byte> bytes);

/// Why the job must end: the first rank that is not ready or, where all are, the first whose terms differ from rank
/// 0's. The terms of the result are empty. Nothing where all agree.
std::optional<Statement> refusal(std::span<const Statement> by_rank);

/// Collective, and the first thing that is, whatever a rank is to do: returns where all ranks have the same terms.
/// Elsewhere rank 0 throws InputError, or std::runtime_error where a rank has met an error that is not bad input, and
/// the others wait for it to end the job. One rank agrees with itself.
void agree(Ranks& ranks, const ImageKey& terms);

/// Ranks::fail() for a rank that the others may be waiting for in agree(): then rank 0 says the error, once however
/// many ranks have one.
int fail(Ranks& ranks, int status, const std::string& text);

}  // namespace raypool::cluster
