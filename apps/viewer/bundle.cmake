# cmake -DNODE= -DNPM= -DSOURCE=apps/viewer -DBUILD=folder -DREPORT=AUTO|ON -P bundle.cmake
# Writes viewer.js, viewer.css and viewer.policy into BUILD; empty ones where npm cannot install and REPORT is AUTO. Packages are
# installed when the lock file changed, never into the source tree.
foreach(file package.json package-lock.json build.mjs)
  file(COPY_FILE ${SOURCE}/${file} ${BUILD}/${file} ONLY_IF_DIFFERENT)
endforeach()

function(leave_out problem)
  if(REPORT STREQUAL "ON")
    message(FATAL_ERROR "NEARPOSE_REPORT is ON, but ${problem}")
  endif()
  message("the report is left out: ${problem}")
  file(WRITE ${BUILD}/viewer.js "")
  file(WRITE ${BUILD}/viewer.css "")
  file(WRITE ${BUILD}/viewer.policy "")
endfunction()

file(SHA256 ${BUILD}/package-lock.json wanted)
set(installed "")
if(EXISTS ${BUILD}/installed_lock)
  file(READ ${BUILD}/installed_lock installed)
endif()
if(NOT installed STREQUAL wanted)
  # No scripts of packages are run; esbuild's library finds its program without.
  execute_process(WORKING_DIRECTORY ${BUILD} RESULT_VARIABLE result OUTPUT_VARIABLE text ERROR_VARIABLE text
    COMMAND ${NPM} ci --no-audit --no-fund --ignore-scripts --prefer-offline --loglevel=error
            --fetch-retries=1 --fetch-retry-mintimeout=1000 --fetch-retry-maxtimeout=5000)
  if(NOT result EQUAL 0)
    leave_out("npm could not install its packages; configure again to retry. It said:\n${text}")
    return()
  endif()
  file(WRITE ${BUILD}/installed_lock ${wanted})
endif()

execute_process(WORKING_DIRECTORY ${BUILD} RESULT_VARIABLE result OUTPUT_VARIABLE text ERROR_VARIABLE text
  COMMAND ${NODE} build.mjs ${SOURCE}/src ${BUILD})
if(NOT result EQUAL 0)
  # Old versions of node and platforms without esbuild; with both there it is a fault of ours.
  leave_out("esbuild failed. It said:\n${text}")
elseif(text)
  message("${text}")
endif()
