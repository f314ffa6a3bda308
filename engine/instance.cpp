#include "engine/instance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace cowgpu::engine {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  auto* log = static_cast<ValidationLog*>(user);
  const std::lock_guard lock(log->mutex);
  log->messages.emplace_back(data->pMessage ? data->pMessage : "(no text)");
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(ValidationLog& log) {
  VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = on_message;
  info.pUserData = &log;
  return info;
}

int rank(VkPhysicalDeviceType type) {
  switch (type) {
  case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 0;
  case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 1;
  case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 2;
  case VK_PHYSICAL_DEVICE_TYPE_CPU: return 3;
  default: return 4;
  }
}

PhysicalDevice examine(VkPhysicalDevice handle) {
  PhysicalDevice device;
  device.handle = handle;
  VkPhysicalDeviceMaintenance3Properties sizes{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
  VkPhysicalDeviceSubgroupProperties subgroup{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES, &sizes};
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES, &subgroup};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  vkGetPhysicalDeviceProperties(handle, &device.properties);
  properties.pNext = device.properties.apiVersion >= VK_API_VERSION_1_2 ? static_cast<void*>(&driver) : &subgroup;
  if (device.properties.apiVersion < VK_API_VERSION_1_1) return device;
  vkGetPhysicalDeviceProperties2(handle, &properties);
  vkGetPhysicalDeviceMemoryProperties(handle, &device.memory);
  VkPhysicalDeviceFeatures features;
  vkGetPhysicalDeviceFeatures(handle, &features);
  device.fp64 = features.shaderFloat64;
  const std::uint32_t version = device.properties.driverVersion;
  device.driver = driver.driverName[0] ? fmt::format("{} {}", driver.driverName, driver.driverInfo)
                                       : fmt::format("driver {}.{}.{}", VK_API_VERSION_MAJOR(version),
                                                     VK_API_VERSION_MINOR(version), VK_API_VERSION_PATCH(version));
  device.subgroup_size = subgroup.subgroupSize;
  device.subgroup_arithmetic = (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) &&
                               (subgroup.supportedOperations & VK_SUBGROUP_FEATURE_SHUFFLE_BIT);
  device.largest_allocation = sizes.maxMemoryAllocationSize;
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(handle, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(handle, &count, families.data());
  for (std::uint32_t f = 0; f < count && device.queue_family < 0; ++f)
    if (families[f].queueFlags & VK_QUEUE_COMPUTE_BIT) device.queue_family = int(f);
  return device;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

} // namespace

void check(VkResult result, const std::string& what) {
  if (result == VK_SUCCESS) return;
  throw Error(result == VK_ERROR_DEVICE_LOST ? Failure::device_lost : Failure::vulkan, result,
              fmt::format("Vulkan could not {}: {}", what, describe_result(result)));
}

const char* PhysicalDevice::type_name() const {
  constexpr std::array names = {"discrete", "integrated", "virtual", "software", "other"};
  return names[std::size_t(rank(properties.deviceType))];
}

std::shared_ptr<Instance> Instance::create(bool validation) {
  if (volkInitialize() != VK_SUCCESS)
    throw Error(Failure::no_loader, 0,
                "there is no Vulkan loader (libvulkan.so.1) on this machine; install libvulkan1 and a driver "
                "(mesa-vulkan-drivers has a software one), or use --device cpu");
  std::shared_ptr<Instance> instance(new Instance);
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "cowgpu";
  application.apiVersion = VK_API_VERSION_1_2;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;

  constexpr std::array features = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT validate{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  validate.enabledValidationFeatureCount = features.size();
  validate.pEnabledValidationFeatures = features.data();
  VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(instance->log_);
  messenger.pNext = &validate;
  const std::array extensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  if (validation) {
    info.pNext = &messenger;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &validation_layer;
    info.enabledExtensionCount = extensions.size();
    info.ppEnabledExtensionNames = extensions.data();
  }
  const VkResult result = vkCreateInstance(&info, nullptr, &instance->handle_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
    throw Error(Failure::no_device, result,
                "there is a Vulkan loader but no driver that works with it; install one (mesa-vulkan-drivers has a "
                "software one) or check VK_DRIVER_FILES, or use --device cpu");
  check(result, validation ? "create an instance with the validation layer (package vulkan-validationlayers)"
                           : "create an instance");
  // The loader's entry points serve every instance and device; only extensions differ between instances.
  volkLoadInstance(instance->handle_);
  if (validation) {
    messenger.pNext = nullptr;
    instance->destroy_messenger_ = vkDestroyDebugUtilsMessengerEXT;
    check(vkCreateDebugUtilsMessengerEXT(instance->handle_, &messenger, nullptr, &instance->messenger_),
          "listen to the validation layer");
  }
  return instance;
}

Instance::~Instance() {
  if (messenger_) destroy_messenger_(handle_, messenger_, nullptr);
  if (handle_) vkDestroyInstance(handle_, nullptr);
}

std::vector<PhysicalDevice> Instance::devices() const {
  std::uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(handle_, &count, nullptr), "count the devices");
  std::vector<VkPhysicalDevice> handles(count);
  check(vkEnumeratePhysicalDevices(handle_, &count, handles.data()), "list the devices");
  std::vector<PhysicalDevice> devices;
  devices.reserve(count);
  for (const VkPhysicalDevice handle : handles) devices.push_back(examine(handle));
  std::stable_sort(devices.begin(), devices.end(), [](const PhysicalDevice& a, const PhysicalDevice& b) {
    return rank(a.properties.deviceType) < rank(b.properties.deviceType);
  });
  return devices;
}

const PhysicalDevice& choose_device(const std::vector<PhysicalDevice>& devices, const std::string& wanted) {
  if (devices.empty())
    throw Error(
        Failure::no_device, 0,
        "there is no Vulkan device on this machine; install a driver (mesa-vulkan-drivers has a software one) or "
        "use --device cpu");
  std::string there;
  for (std::size_t i = 0; i < devices.size(); ++i)
    there += fmt::format("{}{}: {}{}", i ? ", " : "", i, devices[i].properties.deviceName,
                         devices[i].usable() ? "" : " (without double precision)");
  const auto ready = [&](const PhysicalDevice& device) -> const PhysicalDevice& {
    if (!device.usable())
      throw Error(
          Failure::no_fp64, 0,
          fmt::format("the device {} lacks double precision (shaderFloat64), subgroup shuffles or a compute queue, "
                      "which cowgpu needs; there are: {}; or use --device cpu",
                      device.properties.deviceName, there));
    return device;
  };
  if (wanted == "auto") {
    const auto usable = std::find_if(devices.begin(), devices.end(), [](const auto& d) { return d.usable(); });
    return ready(usable == devices.end() ? devices.front() : *usable);
  }
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (error == std::errc() && end == wanted.data() + wanted.size()) {
    if (index < devices.size()) return ready(devices[index]);
  } else if (!wanted.empty()) {
    for (const PhysicalDevice& device : devices)
      if (lower(device.properties.deviceName).find(lower(wanted)) != std::string::npos) return ready(device);
  }
  throw Error(Failure::no_device, 0, fmt::format("there is no device '{}'; there are: {}", wanted, there));
}

} // namespace cowgpu::engine
