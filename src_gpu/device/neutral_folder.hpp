// The current folder is left while an OpenCL driver may build programs.
#pragma once

namespace kiloband::opencl {

/// While one lives, the process stands in "/". Drivers start linkers, and those take files of the current
/// folder for parts of the program: GNU ld looks there first for what a linker script names, such as the
/// libgcc_s.so.1 of PoCL's kernels. A folder of scenes may be a stranger's. Relative names must not be used
/// meanwhile, and other threads must not use any. Several may live at once, of several threads: the first
/// leaves the folder, the last returns to it. Where it could not be entered again, the process stays in it.
class NeutralFolder {
 public:
  NeutralFolder();
  ~NeutralFolder();
  NeutralFolder(const NeutralFolder&) = delete;
  NeutralFolder& operator=(const NeutralFolder&) = delete;

  /// Calls `action`, which belongs to the program, in the folder that was left; where others live, too, their
  /// drivers may build: then it is called in "/".
  template <class Action>
  void from_outside(const Action& action) const {
    const Visit visit;
    action();
  }

 private:
  /// While one lives, no NeutralFolder begins or ends.
  class Visit {
   public:
    Visit();
    ~Visit();
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

   private:
    bool outside_ = false;
  };
};

}  // namespace kiloband::opencl
