/* SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * A program of another vendor, on Cyclone DDS: cyclone_writer DOMAIN COUNT. Writes COUNT messages on each of two topics
 * once both have a reader. */
#include <stdio.h>
#include <stdlib.h>

#include "dds/dds.h"
#include "unknown.h"

static dds_entity_t create_writer(dds_entity_t participant, const dds_topic_descriptor_t* type, const char* name) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 200);
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  dds_entity_t topic = dds_create_topic(participant, type, name, NULL, NULL);
  dds_entity_t writer = dds_create_writer(participant, topic, qos, NULL);
  dds_delete_qos(qos);
  return writer;
}

static void wait_for_reader(dds_entity_t writer) {
  dds_publication_matched_status_t status = {0};
  do {
    dds_sleepfor(DDS_MSECS(5));
    dds_get_publication_matched_status(writer, &status);
  } while (status.current_count == 0);
}

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  dds_entity_t participant = dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL);
  if (participant < 0) {
    fprintf(stderr, "cyclone_writer: %s\n", dds_strretcode(participant));
    return 1;
  }
  dds_entity_t plain = create_writer(participant, &unknown_msgs_msg_dds__Plain__desc, "rt/unknown/plain");
  dds_entity_t keyed = create_writer(participant, &unknown_msgs_msg_dds__Keyed__desc, "rt/unknown/keyed");
  wait_for_reader(plain);
  wait_for_reader(keyed);
  for (uint32_t i = 0; i < (uint32_t)atoi(argv[2]); ++i) {
    unknown_msgs_msg_dds__Plain_ a = {.number = i, .text = "from Cyclone DDS"};
    unknown_msgs_msg_dds__Keyed_ b = {.key = i % 3, .number = i};
    if (dds_write(plain, &a) != 0 || dds_write(keyed, &b) != 0) return 1;
    dds_sleepfor(DDS_MSECS(5));
  }
  dds_wait_for_acks(plain, DDS_SECS(2));
  dds_wait_for_acks(keyed, DDS_SECS(2));
  dds_delete(participant);
  return 0;
}
