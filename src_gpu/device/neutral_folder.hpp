// The current folder is left while an OpenCL driver may build programs.
#pragma once

namespace kiloband::opencl {

/// While one lives, the process stands in "/". Drivers start linkers, and those take files of the current
/// folder for parts of the program: GNU ld looks there first for what a linker script names, such as the
/// libgcc_s.so.1 of PoCL's kernels. A folder of scenes may be a stranger's. Relative names must not be used
/// meanwhile, and other threads must not use any; one at a time. Where the current folder could not be
/// entered again, the process stays in it.
class NeutralFolder {
 public:
  NeutralFolder();
  ~NeutralFolder();
  NeutralFolder(const NeutralFolder&) = delete;
  NeutralFolder& operator=(const NeutralFolder&) = delete;

  /// Calls `action`, which belongs to the program and may use relative names, in the folder that was left.
  template <class Action>
  void from_outside(const Action& action) const {
    const Return visit(*this);
    action();
  }

 private:
  struct Return {
    explicit Return(const NeutralFolder& folder) : folder_(folder) { folder_.enter_left_folder(); }
    ~Return() { folder_.enter_root(); }
    const NeutralFolder& folder_;
  };
  void enter_left_folder() const;
  void enter_root() const;

  int left_ = -1;  // descriptor of the folder that was left; -1: it was not
};

}  // namespace kiloband::opencl
