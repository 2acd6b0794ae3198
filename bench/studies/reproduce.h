/// `raypool study reproduce`: every experiment of the paper, and one page that holds its figures against ours.
///
/// The paper: He, Song, Zong, "Parallel Ray Tracing with OpenMP". Each of its studies runs in a folder of its own below
/// the page's; what they found (Finding::source names the table or figure) is put side by side.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace raypool::studies {

/// The studies that together repeat the paper, in the order of the page.
std::vector<std::string> paper_studies();

/// Writes summary.md into `folder`, from the finished runs in its subfolders, one for each of paper_studies(). Throws
/// InputError for a run that is missing or not finished.
void write_reproduction(const std::filesystem::path& folder);

}  // namespace raypool::studies
