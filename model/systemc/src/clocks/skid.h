// rtl/src/vista_skid.sv: the two-entry buffer at both ends, without its data.
#ifndef VISTA_CLOCKS_SKID_H
#define VISTA_CLOCKS_SKID_H

namespace vista::clocks {

class Skid {
 public:
  bool ready() const { return !spilled_; }
  bool valid() const { return valid_; }

  // A rising edge with the inputs before it.
  void edge(bool valid_in, bool ready_out) {
    if (!valid_ || ready_out) {
      valid_ = spilled_ || valid_in;
      spilled_ = false;
    } else if (valid_in) {
      spilled_ = true;
    }
  }

 private:
  bool valid_ = false, spilled_ = false;
};

}  // namespace vista::clocks

#endif
