// Small files that are kept between runs, below $XDG_CACHE_HOME/kiloband or ~/.cache/kiloband.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace kiloband::opencl {

/// 128 bits of FNV-1a of the text as 32 hex digits: names of files. Twice the bits of other hashes: the name of a program is all that
/// says that it is the one asked for, and a wrong one would render. Not for secrets.
std::string text_hash(std::string_view text);

/// The parts behind their lengths: other parts give another text.
std::string joined_parts(std::initializer_list<std::string_view> parts);

/// The folder `name` of this user's cache; nothing is created. Empty where neither XDG_CACHE_HOME (absolute) nor HOME is set.
std::filesystem::path user_cache(const std::string& name);

/// Makes a folder with all its parents, for this user alone. Returns why it could not be made, "cannot write '/cache/kiloband/programs':
/// Permission denied"; empty if it is there.
std::string make_cache_folder(const std::filesystem::path& folder);

/// Writes a file for this user alone; its folder is made with all its parents. The file is written under another name
/// and renamed, so that processes side by side never see half of one.
/// Returns why it could not be kept, as make_cache_folder() does; empty if it was.
std::string keep_file(const std::filesystem::path& file, std::string_view text);

}  // namespace kiloband::opencl
