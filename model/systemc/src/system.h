// The whole chain, wired: doc/design/system-model.md has the picture.
#ifndef VISTA_SYSTEM_SYSTEM_H
#define VISTA_SYSTEM_SYSTEM_H

#include <memory>
#include <ostream>
#include <systemc>
#include <vector>

#include "background.h"
#include "board_memory.h"
#include "buffer_pool.h"
#include "camera.h"
#include "capture_dma.h"
#include "configuration.h"
#include "engine.h"
#include "fetch_dma.h"
#include "frame_log.h"
#include "front_end.h"
#include "host.h"
#include "host_core.h"
#include "images.h"
#include "link.h"
#include "memory.h"
#include "pair_feed.h"
#include "rectifier.h"
#include "result_dma.h"

namespace vista {

struct Lane {
  std::unique_ptr<Engine> engine;
  std::unique_ptr<FrontEnd> front_end;  // null: none
  std::unique_ptr<ResultDma> result_dma;
  std::unique_ptr<FetchDma> fetch_dma;  // null: the pairs do not come from memory
  std::unique_ptr<PairFeed> pair_feed;  // null: they do
};

class System : public sc_core::sc_module {
 public:
  // `words_out` may be null. Throws ConfigurationError for image files that do not fit.
  System(const sc_core::sc_module_name& name, const Configuration& configuration, std::ostream* words_out);

  // Read by the report, after the simulation.
  const Configuration configuration;
  FrameLog log;
  const Images images;
  Memory memory;  // of the engine
  std::unique_ptr<BoardMemory> board_memory;  // the times of that of a board; null: none
  std::unique_ptr<Memory> host_memory;  // null: the same
  BufferPool captured;
  std::unique_ptr<BufferPool> received;  // on a board; null: none
  std::unique_ptr<BufferPool> rectified;  // null: pairs come rectified
  BufferPool results;
  std::unique_ptr<BufferPool> fetched;  // from a board; null: none
  std::unique_ptr<Link> link;
  HostCore host_core, rectify_core;  // the second only with two cores
  std::unique_ptr<Camera> camera;  // with capture_dma; null: the cameras are the board's
  std::unique_ptr<CaptureDma> capture_dma;
  std::unique_ptr<Rectifier> rectifier;
  std::vector<Lane> lanes;
  Host host;
  std::unique_ptr<Background> background;

 private:
  std::vector<Lane> make_lanes();
  std::unique_ptr<Link> make_link();
  Memory& memory_of_host() { return host_memory ? *host_memory : memory; }
};

}  // namespace vista

#endif
