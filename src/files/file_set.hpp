// Files that belong together, such as an ENVI header and its data: they change their names as one.
#pragma once

#include <functional>
#include <vector>

#include "files/atomic_file.hpp"

namespace kiloband {

/// Two processes that write the same outputs at once must not leave one's header with the other's data. So
/// the names of a set change under a claim (FolderClaim) on the folders of all its files. It is
/// held for the renames alone, not while data are written or reach the disk, and who comes second replaces
/// all files of the first. Where it cannot be had, the set is written without, and whether all files are
/// its own is checked afterwards: if not, what is of this set is removed again, last file first, and commit()
/// fails, so that data never have a header of another render.
/// Sets with special files (pipes, devices) have no claim.
class FileSet {
 public:
  /// In the order in which they are to appear: a file that describes others comes after them.
  /// The file must outlive commit().
  void add(AtomicFile& file) { files_.push_back(&file); }
  /// What is to happen under the claim before the first name changes, such as removing a header of old data.
  void before(std::function<void()> action) { before_.push_back(std::move(action)); }
  /// throws DeviceError  "cannot write 'FILE': ..."
  void commit();

 private:
  void check_all_stand() const;

  std::vector<AtomicFile*> files_;
  std::vector<std::function<void()>> before_;
};

}  // namespace kiloband
