/// What rows say, in Python: scripts/analysis reads data.csv and run.json, and adds findings, tables, a page and
/// pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace raypool::studies {

/// Of a finished run: its findings into run.json, summary.md, index.html, and every picture as SVG and PNG. Needs
/// Debian's python3-matplotlib, and python3-jinja2 for index.html, which else is left out. Throws std::runtime_error,
/// in one line, where that is missing or the analysis failed: the data are complete then, and the same command goes on
/// from there.
void analyse(const std::filesystem::path& folder);

/// Two pages in `folder` over the analysed runs of studies in its subfolders, in their order: summary.md, the paper's
/// figures against ours, and beyond.md, what the paper did not ask; and in `folder`/site those of write_report().
/// Throws as analyse() does.
void write_reproduction(const std::filesystem::path& folder, const std::vector<std::string>& of_paper,
                        const std::vector<std::string>& beyond);

/// Pages in the folder `site`: a list of the runs in `folders`, each as a page to look into, and every two of one study
/// side by side. Returns the exit status: what is wrong with a folder has then been said. Throws std::runtime_error, in
/// one line, where a package is missing.
int write_report(const std::vector<std::string>& folders, const std::string& site);

}  // namespace raypool::studies
