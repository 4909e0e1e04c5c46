// One rectified stereo pair from two PGM files: matches it and prints how far away the obstacles in it are.
//   pair LEFT.pgm RIGHT.pgm FOCAL_PX BASELINE_M
#include <vista/engine.h>
#include <vista/frontend.h>
#include <vista/vista.h>

#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

struct Image {
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> grey;
};

Image read_pgm(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  Image image;
  int white = 0;
  if (!(file >> magic >> image.width >> image.height >> white) || magic != "P5" || white != 255 || image.width < 1 ||
      image.height < 1 || image.width > VISTA_ENGINE_MAX_SIDE_PX || image.height > VISTA_ENGINE_MAX_SIDE_PX)
    throw std::runtime_error(path + ": not a binary PGM file with 8 bits a pixel");
  file.get();  // the line's end
  image.grey.resize(static_cast<std::size_t>(image.width) * image.height);
  if (!file.read(reinterpret_cast<char*>(image.grey.data()), static_cast<std::streamsize>(image.grey.size())))
    throw std::runtime_error(path + ": cut off");
  return image;
}

void check(vista_status status) {
  if (status != VISTA_OK) throw std::runtime_error(vista_status_text(status));
}

void check(vista_engine_status status) {
  if (status != VISTA_ENGINE_OK) throw std::runtime_error(vista_engine_status_text(status));
}

std::vector<std::int16_t> match(const Image& left, const Image& right, const vista_engine_params& engine) {
  std::vector<std::int16_t> words(left.grey.size());
  const vista_engine_images images{left.grey.data(), right.grey.data(), left.width,
                                   left.height,      left.width,        left.width};
  const vista_engine_output output{words.data(), nullptr, left.width, 0};
  const std::size_t bytes = vista_engine_scratch_bytes(&engine, left.width, left.height, 1);
  struct alignas(64) Block {
    unsigned char bytes[64];
  };
  std::vector<Block> scratch(bytes / sizeof(Block) + 1);
  check(vista_engine_compute(&engine, &images, &output, scratch.data(), bytes));
  return words;
}

Image smoothed(const Image& image) {
  Image out{image.width, image.height, std::vector<std::uint8_t>(image.grey.size())};
  const vista_frontend_image in{image.grey.data(), image.width, image.height, image.width};
  check(vista_frontend_smooth(&in, out.grey.data(), out.width, VISTA_ENGINE_ISA_AUTO));
  return out;
}

Image reduced(const Image& image) {
  Image out{vista_frontend_reduced_px(image.width), vista_frontend_reduced_px(image.height), {}};
  out.grey.resize(static_cast<std::size_t>(out.width) * out.height);
  const vista_frontend_image in{image.grey.data(), image.width, image.height, image.width};
  check(vista_frontend_reduce(&in, out.grey.data(), out.width, VISTA_ENGINE_ISA_AUTO));
  return out;
}

void run(const std::string& left_path, const std::string& right_path, double focal_px, double baseline_m) {
  Image left = read_pgm(left_path), right = read_pgm(right_path);
  if (left.width != right.width || left.height != right.height) throw std::runtime_error("the images differ in size");

  constexpr int levels = 3;
  vista_engine_params engine = vista_engine_defaults();
  vista_parameters parameters = vista_parameters_default();
  engine.num_disparities = parameters.stereo.num_disparities;
  // One picture has to do, so a track is confirmed when it is first seen.
  check(vista_parameters_set(&parameters, "tracker.confirm_hits", 1));
  const vista_camera camera{left.width, left.height, focal_px, (left.width - 1) / 2.0, (left.height - 1) / 2.0,
                            baseline_m};
  std::size_t bytes = 0;
  check(vista_pipeline_bytes(&parameters, &camera, &bytes));
  std::vector<unsigned char> memory(bytes);
  vista_pipeline* pipeline = nullptr;
  check(vista_pipeline_create(memory.data(), bytes, &parameters, &camera, &pipeline));

  const Image image = left;
  vista_frame frame{};
  frame.image = {image.grey.data(), image.width, image.height, image.width};
  std::vector<std::int16_t> words[levels];  // what is too near for one level is matched by the next
  for (int k = 0; k < levels; ++k) {
    words[k] = match(smoothed(left), smoothed(right), engine);
    (k == 0 ? frame.disparity : frame.coarser[k - 1]) = {words[k].data(), left.width, left.height, left.width};
    left = reduced(left);
    right = reduced(right);
  }
  vista_result result;
  check(vista_pipeline_process(pipeline, &frame, &result));

  std::cout << "libvista " << vista_version() << ": " << 100.0 * result.valid_fraction << " % of the pixels matched\n";
  for (std::int32_t i = 0; i < result.obstacle_count; ++i) {
    const vista_obstacle& obstacle = *vista_result_obstacle(&result, i);
    if (obstacle.confirmed)
      std::cout << "obstacle at " << obstacle.distance_m << " m, " << obstacle.extent_m[0] << " m wide and "
                << obstacle.extent_m[1] << " m high\n";
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) throw std::runtime_error("usage: pair LEFT.pgm RIGHT.pgm FOCAL_PX BASELINE_M");
  run(argv[1], argv[2], std::stod(argv[3]), std::stod(argv[4]));
  return 0;
} catch (const std::exception& error) {
  std::cerr << "pair: " << error.what() << '\n';
  return 1;
}
