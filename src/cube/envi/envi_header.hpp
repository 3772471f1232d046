// The text header of an ENVI file: what it says about the numbers beside it, and its own small grammar.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cube/cube_io.hpp"

namespace kiloband {

/// "key = value" entries in file order; a list value keeps its braces away and its line breaks in.
class EnviHeader {
 public:
  struct Entry {
    std::string key;    // as written
    std::string lower;  // what keys are compared by
    std::string value;  // trimmed
    int line = 0;
    bool list = false;  // was in braces
  };

  /// throws InputError  "file:line: ..." (no ENVI on the first line, no '=', '{' without '}')
  EnviHeader(const std::filesystem::path& file, std::string_view text);

  const std::vector<Entry>& entries() const { return entries_; }
  const Entry* find(std::string_view lower_key) const;
  /// "FILE:LINE: KEY" for messages about an entry.
  std::string where(const Entry& entry) const;
  const std::filesystem::path& file() const { return file_; }

  /// An unsigned number of at most `largest`; `fallback` if the key is missing,
  /// an InputError if there is none either.
  uint64_t count(std::string_view key, uint64_t largest,
                 std::optional<uint64_t> fallback = std::nullopt) const;
  /// A list of exactly `size` numbers or texts; empty if the key is missing.
  std::vector<double> numbers(std::string_view key, std::size_t size) const;
  std::vector<std::string> texts(std::string_view key, std::size_t size) const;

 private:
  std::filesystem::path file_;
  std::vector<Entry> entries_;
};

enum class EnviInterleave { kBsq, kBil, kBip };

/// How the numbers lie in the data file.
struct EnviStorage {
  uint32_t samples = 0, lines = 0, bands = 0;
  uint64_t offset = 0;  // bytes before the first number
  int data_type = 4;    // ENVI's code
  EnviInterleave interleave = EnviInterleave::kBsq;
  bool big_endian = false;

  uint64_t bytes_per_value() const;
  /// Of the numbers without the offset; limits on the sizes keep it below 2^63.
  uint64_t bytes() const { return bytes_per_value() * samples * lines * bands; }
};

/// throws InputError  a mandatory key is missing, wrong, or of a kind that cannot be read (complex numbers, bytes
///                    between frames, the header of a newer kiloband)
EnviStorage read_envi_storage(const EnviHeader& header);

/// The cube of a main header, without looking at other files. info.variance and info.aux are left empty.
CubeInfo read_envi_info(const EnviHeader& header, const EnviStorage& storage, const DiagnosticSink& sink);

/// What a data file of ours holds.
enum class EnviContent { kValues, kVariance, kAux };
std::string envi_header_text(const CubeInfo& info, EnviContent content);
/// Whether a header is that of variances or auxiliary planes of ours, and not a cube's whose name ends like theirs.
bool is_envi_part(const EnviHeader& header, EnviContent content);

/// X.hdr -> X, the common stem of a cube's files.
std::filesystem::path envi_stem(const std::filesystem::path& header);
/// Of a header that is to be written: data and parts stand beside the file that a link leads to.
std::filesystem::path envi_output_stem(const std::filesystem::path& header);
std::filesystem::path envi_file(const std::filesystem::path& stem, EnviContent content,
                                const char* extension);

// Keys of our own.
inline constexpr std::string_view kEnviLayoutKey = "kiloband layout";
inline constexpr std::string_view kEnviQuantityKey = "kiloband quantity";
inline constexpr std::string_view kEnviContentKey = "kiloband content";
inline constexpr std::string_view kEnviSamplesKey = "kiloband samples per pixel";
inline constexpr std::string_view kEnviReplicatesKey = "kiloband replicates";
inline constexpr std::string_view kEnviReplicateSamplesKey = "kiloband replicate samples";
inline constexpr std::string_view kEnviMinKey = "kiloband band minimum";
inline constexpr std::string_view kEnviMaxKey = "kiloband band maximum";
inline constexpr std::string_view kEnviDerivedKey = "kiloband derived bands";
inline constexpr std::string_view kEnviNamesKey = "kiloband own names";
inline constexpr std::string_view kEnviVarianceKey = "kiloband variance";
inline constexpr std::string_view kEnviAuxKey = "kiloband aux";
inline constexpr std::string_view kEnviMetaPrefix = "meta.";

/// Keys that metadata must not take: those of the format that we read or write, and ours.
bool is_reserved_envi_key(std::string_view lower_key);

}  // namespace kiloband
