#include "apps/simulate/staged_folder.hpp"

#include <stdlib.h>
#include <sys/stat.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "apps/base/file_io.hpp"

namespace nearpose::simulate {
namespace {

namespace fs = std::filesystem;

// `path` without a separator at its end, which would make its file name empty.
fs::path plain(const fs::path& path) {
    fs::path whole = fs::absolute(path).lexically_normal();
    return whole.has_filename() ? whole : whole.parent_path();
}

void require_replaceable(const fs::path& target, bool replace, const std::set<std::string>& known_entries) {
    if (!fs::exists(fs::symlink_status(target))) return;
    if (!fs::is_directory(fs::symlink_status(target))) {
        throw std::runtime_error(target.string() + ": is there and is no folder; name another place");
    }
    if (fs::is_empty(target)) return;
    if (!replace) {
        throw std::runtime_error(target.string() +
                                 ": is there and not empty; name another folder, or use --force to "
                                 "replace it");
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(target)) {
        const std::string name = entry.path().filename().string();
        if (known_entries.count(name) > 0) continue;
        throw std::runtime_error(target.string() + ": holds " + name +
                                 ", which is not part of a simulated data set and would be lost; move it away first");
    }
}

// A new folder of a name of its own.
fs::path make_unique_folder(const std::string& prefix) {
    std::string name = prefix + "XXXXXX";
    if (mkdtemp(name.data()) == nullptr) {
        const int cause = errno;
        throw std::runtime_error(name + ": cannot create this folder: " + std::generic_category().message(cause));
    }
    return name;
}

void rename_or_throw(const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::rename(from, to, error);
    if (error) throw std::runtime_error(to.string() + ": cannot be put in place: " + error.message());
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& target, bool replace, const std::set<std::string>& known_entries)
    : target_(plain(target)) {
    require_replaceable(target_, replace, known_entries);
    data_set::create_folder(target_.parent_path());
    staging_ = make_unique_folder((target_.parent_path() / ("." + target_.filename().string() + ".new-")).string());
    // mkdtemp makes folders that nobody else may read; a data set is as any other folder here.
    const mode_t mask = umask(0);
    umask(mask);
    fs::permissions(staging_, static_cast<fs::perms>(0777 & ~mask));
}

StagedFolder::~StagedFolder() {
    std::error_code ignored;
    if (!staging_.empty()) fs::remove_all(staging_, ignored);
}

void StagedFolder::commit() {
    if (!fs::exists(target_) || fs::is_empty(target_)) {
        rename_or_throw(staging_, target_);  // an empty folder may be renamed over
        staging_.clear();
        return;
    }
    const fs::path old =
        make_unique_folder((target_.parent_path() / ("." + target_.filename().string() + ".old-")).string());
    rename_or_throw(target_, old);
    try {
        rename_or_throw(staging_, target_);
    } catch (...) {
        fs::rename(old, target_);
        throw;
    }
    staging_.clear();
    std::error_code error;
    fs::remove_all(old, error);
    if (error) throw std::runtime_error(old.string() + ": the replaced data set cannot be removed: " + error.message());
}

}  // namespace nearpose::simulate
