#include "cluster/agreement.h"

#include <stdexcept>

#include <fmt/format.h>

#include "core/base/error.h"

namespace raypool::cluster {

namespace {

/// All statements at rank 0; nothing elsewhere.
std::vector<Statement> told(Ranks& ranks, const Statement& own) {
    std::vector<Statement> by_rank;
    for (const std::vector<std::byte>& bytes : ranks.gather(encoded(own))) by_rank.push_back(decoded(bytes));
    return by_rank;
}

/// A rank that refuses ends the job and does not come here, so no rank goes on.
void wait_for_all(Ranks& ranks) {
    (void)ranks.greatest(0);
}

}  // namespace

std::vector<std::byte> encoded(const Statement& statement) {
    std::string text;  // texts that end in a zero, which none contains: status, error, then names and values
    const auto add = [&](const std::string& part) { text.append(part.c_str()).push_back('\0'); };
    add(fmt::to_string(statement.status));
    add(statement.error);
    for (const auto& [name, value] : statement.terms) {
        add(name);
        add(value);
    }
    const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

Statement decoded(std::span<const std::byte> bytes) {
    std::vector<std::string> parts(1);
    for (const std::byte byte : bytes) {
        if (byte == std::byte{0}) {
            parts.emplace_back();
        } else {
            parts.back().push_back(static_cast<char>(byte));
        }
    }
    Statement statement{std::stoi(parts.at(0)), parts.at(1), {}};
    for (std::size_t i = 2; i + 1 < parts.size(); i += 2) statement.terms.emplace_back(parts[i], parts[i + 1]);
    return statement;
}

std::optional<Statement> refusal(std::span<const Statement> by_rank) {
    for (std::size_t rank = 0; rank < by_rank.size(); ++rank)
        if (const auto& [status, error, terms] = by_rank[rank]; status != 0)
            return Statement{status, fmt::format("rank {} of {}: {}", rank, by_rank.size(), error), {}};
    for (std::size_t rank = 1; rank < by_rank.size(); ++rank)
        if (const std::string differs = difference(by_rank[rank].terms, by_rank[0].terms); !differs.empty())
            return Statement{
                2, fmt::format("rank {} of {} differs from rank 0: {}", rank, by_rank.size(), differs), {}};
    return std::nullopt;
}

void agree(Ranks& ranks, const ImageKey& terms) {
    if (ranks.count() == 1) return;
    if (const std::optional<Statement> refused = refusal(told(ranks, {0, "", terms}))) {
        if (refused->status == 2) throw InputError(refused->error);
        throw std::runtime_error(refused->error);
    }
    wait_for_all(ranks);
    ranks.set_agreed();
}

int fail(Ranks& ranks, int status, const std::string& text) {
    if (!ranks.is_first() && !ranks.has_agreed()) {
        told(ranks, {status, text, {}});
        wait_for_all(ranks);
    }
    return ranks.fail(status, text);
}

}  // namespace raypool::cluster
