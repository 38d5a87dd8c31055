!> Who is near whom: the list of near pairs, by boxes swept along x, and its colours for threads.
module dem_search
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use dem_bodies, only : body_set, most_vertices
   use dem_contacts, only : contact_pair, contact_set, overlap, measure_overlap, choose_edges, pair_loss, place_part
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: search_pairs

   integer, parameter :: most_colours = 62

contains

   !> Rebuild the list of near pairs; persistent ones keep their memory
   subroutine search_pairs(set, contacts, first_time, status)
      type(body_set), intent(inout) :: set
      type(contact_set), intent(inout) :: contacts
      logical, intent(in) :: first_time           !! contacts found now may carry a bond
      integer(c_int), intent(out) :: status
      integer :: n, i, j, p, q, k, found, failed

      n = size(set%parts)
      status = status_out_of_memory
      if (first_time) then
         allocate (contacts%pair(8 * n), contacts%spare(8 * n), contacts%row(n + 1), contacts%sequence(8 * n), &
            contacts%sweep(n), contacts%box(4, n), contacts%used(size(set%item)), &
            contacts%colour_first(most_colours + 3), stat=failed)
         if (failed /= 0) return
         do i = 1, n
            contacts%sweep(i) = i
         end do
         contacts%row = 1
      end if
      call update_boxes(set, contacts)
      call sort_boxes(contacts)
      found = 0
      do i = 1, n
         p = contacts%sweep(i)
         do j = i + 1, n
            q = contacts%sweep(j)
            if (contacts%box(1, q) > contacts%box(2, p)) exit
            if (contacts%box(3, q) > contacts%box(4, p) .or. contacts%box(3, p) > contacts%box(4, q)) cycle
            if (set%parts(p)%owner == set%parts(q)%owner) cycle
            if (set%item(set%parts(p)%owner)%fixed .and. set%item(set%parts(q)%owner)%fixed) cycle
            if (found == size(contacts%spare)) then
               call grow_pairs(contacts, failed)
               if (failed /= 0) return
            end if
            call consider_pair(set, contacts, min(p, q), max(p, q), first_time, contacts%spare(found + 1), k)
            found = found + k
         end do
      end do
      call sort_pairs(set, contacts, found, failed)
      if (failed /= 0) return
      call colour_pairs(set, contacts)
      set%item%seen_x = set%item%x
      set%item%seen_y = set%item%y
      set%item%seen_angle = set%item%angle
      status = status_ok
   end subroutine search_pairs

   !> Boxes of all parts, wider by half the skin
   pure subroutine update_boxes(set, contacts)
      type(body_set), intent(in) :: set
      type(contact_set), intent(inout) :: contacts
      real(wp) :: x(2, most_vertices)
      integer :: p, n
      do p = 1, size(set%parts)
         call place_part(set, p, x, n)
         contacts%box(1, p) = minval(x(1, 1:n)) - 0.5_wp * contacts%skin
         contacts%box(2, p) = maxval(x(1, 1:n)) + 0.5_wp * contacts%skin
         contacts%box(3, p) = minval(x(2, 1:n)) - 0.5_wp * contacts%skin
         contacts%box(4, p) = maxval(x(2, 1:n)) + 0.5_wp * contacts%skin
      end do
   end subroutine update_boxes

   !> Insertion sort by the left ends: the order of the last search is nearly right
   pure subroutine sort_boxes(contacts)
      type(contact_set), intent(inout) :: contacts
      integer :: i, j, p
      do i = 2, size(contacts%sweep)
         p = contacts%sweep(i)
         j = i - 1
         do while (j >= 1)
            if (contacts%box(1, contacts%sweep(j)) <= contacts%box(1, p)) exit
            contacts%sweep(j + 1) = contacts%sweep(j)
            j = j - 1
         end do
         contacts%sweep(j + 1) = p
      end do
   end subroutine sort_boxes

   !> Twice the room for pairs
   subroutine grow_pairs(contacts, failed)
      type(contact_set), intent(inout) :: contacts
      integer, intent(out) :: failed
      type(contact_pair), allocatable :: bigger(:)
      integer, allocatable :: longer(:)
      integer :: n
      n = 2 * size(contacts%spare)
      allocate (bigger(n), stat=failed)
      if (failed /= 0) return
      bigger(1:size(contacts%spare)) = contacts%spare
      call move_alloc(bigger, contacts%spare)
      allocate (longer(n), stat=failed)
      if (failed /= 0) return
      longer(1:size(contacts%sequence)) = contacts%sequence
      call move_alloc(longer, contacts%sequence)
   end subroutine grow_pairs

   !> Write the pair of parts p < q where they are within the skin; took is 1 then, else 0
   subroutine consider_pair(set, contacts, p, q, first_time, pair, took)
      type(body_set), intent(in) :: set
      type(contact_set), intent(in) :: contacts
      integer, intent(in) :: p
      integer, intent(in) :: q
      logical, intent(in) :: first_time
      type(contact_pair), intent(out) :: pair
      integer, intent(out) :: took
      integer :: k
      real(wp) :: distance
      type(overlap) :: now

      if (.not. first_time) then
         do k = contacts%row(p), contacts%row(p + 1) - 1
            if (maxval(contacts%pair(contacts%sequence(k))%parts) == q) pair = contacts%pair(contacts%sequence(k))
         end do
      end if
      if (pair%parts(1) == 0) then
         pair%parts = [p, q]
         pair%bodies = [set%parts(p)%owner, set%parts(q)%owner]
         pair%joint = joint_between(contacts, pair%bodies(1), pair%bodies(2))
         if (pair%joint > 0) pair%law = contacts%law_number(pair%joint)
      end if
      call choose_edges(set, contacts%skin, pair, distance)
      took = merge(1, 0, distance <= contacts%skin)
      if (took == 0) return
      call measure_overlap(pair, set%item(pair%bodies(1)), set%item(pair%bodies(2)), now)
      pair%careful = now%width < 2.0_wp * contacts%skin
      if (first_time) pair%point%bonded = .not. pair%careful .and. now%gap <= 0.05_wp * contacts%skin
   end subroutine consider_pair

   !> Row of the law table of the joint between two bodies, 0 without one
   pure function joint_between(contacts, a, b) result(joint)
      type(contact_set), intent(in) :: contacts
      integer, intent(in) :: a
      integer, intent(in) :: b
      integer :: joint
      integer :: k
      joint = 0
      do k = contacts%law_first(min(a, b)), contacts%law_first(min(a, b) + 1) - 1
         if (contacts%law_body(k) == max(a, b)) joint = k
      end do
   end function joint_between

   !> Sort the pairs found by their parts and remember what the vanished ones have lost
   subroutine sort_pairs(set, contacts, found, failed)
      type(body_set), intent(in) :: set
      type(contact_set), intent(inout) :: contacts
      integer, intent(in) :: found
      integer, intent(out) :: failed
      integer :: i, j, k, p
      type(contact_pair) :: moving
      integer, allocatable :: fill(:)
      real(wp) :: total(3)

      failed = 0
      total = losses(contacts%pair, contacts%pairs)
      call count_joint_losses(contacts, 1.0_wp)
      contacts%friction_loss = contacts%friction_loss + total(1)
      contacts%damping_loss = contacts%damping_loss + total(2)
      contacts%support_work = contacts%support_work + total(3)
      if (size(contacts%pair) < size(contacts%spare)) then
         deallocate (contacts%pair)
         allocate (contacts%pair(size(contacts%spare)), stat=failed)
         if (failed /= 0) return
      end if
      allocate (fill(size(set%parts) + 1), stat=failed)
      if (failed /= 0) return
      fill = 0
      do k = 1, found
         p = minval(contacts%spare(k)%parts)
         fill(p) = fill(p) + 1
      end do
      contacts%row(1) = 1
      do p = 1, size(set%parts)
         contacts%row(p + 1) = contacts%row(p) + fill(p)
      end do
      fill(1:size(set%parts)) = contacts%row(1:size(set%parts))
      do k = 1, found
         p = minval(contacts%spare(k)%parts)
         contacts%pair(fill(p)) = contacts%spare(k)
         fill(p) = fill(p) + 1
      end do
      do p = 1, size(set%parts)
         do i = contacts%row(p) + 1, contacts%row(p + 1) - 1
            moving = contacts%pair(i)
            j = i - 1
            do while (j >= contacts%row(p))
               if (maxval(contacts%pair(j)%parts) <= maxval(moving%parts)) exit
               contacts%pair(j + 1) = contacts%pair(j)
               j = j - 1
            end do
            contacts%pair(j + 1) = moving
         end do
      end do
      contacts%pairs = found
      total = losses(contacts%pair, found)
      call count_joint_losses(contacts, -1.0_wp)
      contacts%friction_loss = contacts%friction_loss - total(1)
      contacts%damping_loss = contacts%damping_loss - total(2)
      contacts%support_work = contacts%support_work - total(3)
   end subroutine sort_pairs

   !> Add the losses of the pairs, times `sense`, to those of their joints
   pure subroutine count_joint_losses(contacts, sense)
      type(contact_set), intent(inout) :: contacts
      real(wp), intent(in) :: sense
      integer :: k
      do k = 1, contacts%pairs
         associate (pair => contacts%pair(k))
            if (pair%joint > 0) contacts%joint_loss(:, pair%joint) = contacts%joint_loss(:, pair%joint) &
               + sense * pair_loss(pair)
         end associate
      end do
   end subroutine count_joint_losses

   !> Friction loss, damping loss and support work remembered by the pairs [J]
   pure function losses(pair, n) result(total)
      type(contact_pair), intent(in) :: pair(:)
      integer, intent(in) :: n
      real(wp) :: total(3)
      integer :: k
      total = 0.0_wp
      do k = 1, n
         total(1:2) = total(1:2) + pair_loss(pair(k))
         total(3) = total(3) + pair(k)%support_work
      end do
   end function losses

   !> Colours such that two pairs of one colour share no mobile body: a colour may run in parallel,
   !> and the result is that of one thread bit for bit. Pairs beyond the last
   !> colour run one by one.
   subroutine colour_pairs(set, contacts)
      type(body_set), intent(in) :: set
      type(contact_set), intent(inout) :: contacts
      integer :: k, c, i, b, count(most_colours + 1)
      integer(c_int64_t) :: bits

      contacts%used = 0_c_int64_t
      count = 0
      contacts%sequence(1:contacts%pairs) = 0
      do k = 1, contacts%pairs
         bits = 0_c_int64_t
         do i = 1, 2
            b = contacts%pair(k)%bodies(i)
            if (.not. set%item(b)%fixed) bits = ior(bits, contacts%used(b))
         end do
         c = 0
         do while (c < most_colours .and. btest(bits, c))
            c = c + 1
         end do
         do i = 1, 2
            b = contacts%pair(k)%bodies(i)
            if (c < most_colours) contacts%used(b) = ibset(contacts%used(b), c)
         end do
         contacts%sequence(k) = c + 1
         count(c + 1) = count(c + 1) + 1
      end do
      contacts%colour_first(1) = 1
      do c = 1, most_colours + 1
         contacts%colour_first(c + 1) = contacts%colour_first(c) + count(c)
      end do
      contacts%colours = most_colours + 1
      do while (contacts%colours > 0)
         if (count(contacts%colours) > 0) exit
         contacts%colours = contacts%colours - 1
      end do
      contacts%alone = merge(1, 0, contacts%colours > most_colours)
      ! Pairs of one colour lie side by side: a sweep reads them in order.
      count = contacts%colour_first(1:most_colours + 1)
      do k = 1, contacts%pairs
         c = contacts%sequence(k)
         contacts%sequence(k) = count(c)
         contacts%spare(count(c)) = contacts%pair(k)
         count(c) = count(c) + 1
      end do
      contacts%pair(1:contacts%pairs) = contacts%spare(1:contacts%pairs)
   end subroutine colour_pairs

end module dem_search
