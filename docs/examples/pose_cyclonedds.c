/* SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Prints the poses of the camera with Cyclone DDS: pose_cyclonedds [COUNT]. ROS_DOMAIN_ID sets the domain. */
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>

#include "geometry_msgs.h"

int main(int argc, char** argv) {
  int left = argc > 1 ? atoi(argv[1]) : 100;
  const char* domain = getenv("ROS_DOMAIN_ID");
  dds_entity_t participant = dds_create_participant(domain ? (dds_domainid_t)atoi(domain) : 0, NULL, NULL);
  if (participant < 0) {
    fprintf(stderr, "no participant: %s\n", dds_strretcode(participant));
    return 1;
  }
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
  dds_entity_t topic =
      dds_create_topic(participant, &geometry_msgs_msg_dds__PoseStamped__desc, "rt/slam/pose", NULL, NULL);
  dds_entity_t reader = dds_create_reader(participant, topic, qos, NULL);
  dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
  dds_entity_t waitset = dds_create_waitset(participant);
  dds_waitset_attach(waitset, reader, 0);
  while (left > 0 && dds_waitset_wait(waitset, NULL, 0, DDS_SECS(20)) > 0) {
    void* sample = NULL;
    dds_sample_info_t info;
    while (left > 0 && dds_take(reader, &sample, &info, 1, 1) == 1) {
      const geometry_msgs_msg_dds__PoseStamped_* pose = sample;
      const geometry_msgs_msg_dds__Point_* at = &pose->pose.position;
      const std_msgs_msg_dds__Header_* header = &pose->header;
      if (info.valid_data && left-- > 0)
        printf("%d.%09u %s %.3f %.3f %.3f\n", header->stamp.sec, header->stamp.nanosec, header->frame_id, at->x, at->y,
               at->z);
      dds_return_loan(reader, &sample, 1);
    }
  }
  dds_delete(participant);
  return left > 0 ? 1 : 0;
}
