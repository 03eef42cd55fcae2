# FLANN comes with a pkg-config file only. Used by the build and by the installed package, so that the latter looks for
# FLANN where it is used and not where the package was built. Defines PkgConfig::flann.
find_package(PkgConfig QUIET)
if(PkgConfig_FOUND AND NOT TARGET PkgConfig::flann)
  pkg_check_modules(flann QUIET IMPORTED_TARGET GLOBAL flann)
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(NearposeFlann REQUIRED_VARS flann_FOUND VERSION_VAR flann_VERSION)
