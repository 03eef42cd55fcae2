// A folder that appears whole or not at all.
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace nearpose::simulate {

// A new folder beside the wanted one, which takes its place at commit(); destroyed before that, it goes away with all
// that is in it, and what stood in its place is left as it was.
class StagedFolder {
  public:
    // `known_entries` are the names that such a folder may hold. Throws std::runtime_error where `target` is there and
    // not an empty folder, unless `replace`; and even then where it holds anything else, which would be lost.
    StagedFolder(const std::filesystem::path& target, bool replace, const std::set<std::string>& known_entries);
    ~StagedFolder();
    StagedFolder(const StagedFolder&) = delete;
    StagedFolder& operator=(const StagedFolder&) = delete;

    const std::filesystem::path& path() const { return staging_; }
    void commit();

  private:
    std::filesystem::path target_;
    std::filesystem::path staging_;
};

}  // namespace nearpose::simulate
