!> Contacts as drawn whose forces are recorded with their places, in the plane and in space: a place is the centre of the normal
!> forces of the contact points. A pair of bodies may have several contacts; each point counts for the nearest one.
module dem_places
   use common_kinds, only : wp
   use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: place_table, places_new, places_copy, count_places, add_force, press_rows

   !> Rows of a record: force on the first body x, y, z [N], normal force [N], and its moments: times x, y, z of its place [N m]
   integer, parameter :: press_rows = 7

   !> All in the axes of the first body of each pair, from its centroid
   type :: place_table
      integer, allocatable :: first(:)              !! (joints + 1) first contact of each pair of bodies
      integer, allocatable :: corner(:)             !! (contacts + 1) first corner of each contact
      real(wp), allocatable :: x(:, :)              !! (3, corners) around each contact [m]
      real(wp), allocatable :: normal(:, :)         !! (3, contacts) unit vectors, of either sense
   end type place_table

contains

   !> A table of contacts, ascending by their pairs of bodies
   subroutine places_new(joint, corner, x, normal, table, status)
      integer(c_int), intent(in) :: joint(:)        !! (contacts) row of the pair in the table of joints, 1-based
      integer(c_int), intent(in) :: corner(:)       !! (contacts + 1) first corner, 1-based
      real(wp), intent(in) :: x(:, :)               !! (3, corners) [m]
      real(wp), intent(in) :: normal(:, :)          !! (3, contacts)
      type(place_table), intent(out) :: table
      integer(c_int), intent(out) :: status         !! bad_index for rows that are not ascending, invalid for a contact of one corner
      integer :: k, n, joints, failed
      n = size(joint)
      status = status_bad_index
      if (n == 0) return
      if (joint(1) < 1 .or. any(joint(2:) < joint(:n - 1))) return
      status = status_invalid_argument
      if (corner(1) /= 1 .or. corner(n + 1) /= size(x, 2) + 1 .or. any(corner(2:) - corner(:n) < 2)) return
      joints = int(joint(n))
      allocate (table%first(joints + 1), table%corner(n + 1), table%x(3, size(x, 2)), table%normal(3, n), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      table%corner(:) = corner
      table%x(:, :) = x
      table%normal(:, :) = normal
      table%first(:) = n + 1
      do k = n, 1, -1
         table%first(:joint(k)) = k
      end do
   end subroutine places_new

   !> The same table again; without contacts nothing is recorded
   subroutine places_copy(from, to, status)
      type(place_table), intent(in) :: from
      type(place_table), intent(out) :: to
      integer(c_int), intent(out) :: status
      integer :: failed
      status = status_ok
      if (.not. allocated(from%first)) return
      allocate (to%first(size(from%first)), to%corner(size(from%corner)), to%x(3, size(from%x, 2)), &
         to%normal(3, size(from%normal, 2)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      to%first(:) = from%first
      to%corner(:) = from%corner
      to%x(:, :) = from%x
      to%normal(:, :) = from%normal
   end subroutine places_copy

   !> Contacts that are recorded
   pure function count_places(table) result(contacts)
      type(place_table), intent(in) :: table
      integer :: contacts
      contacts = 0
      if (allocated(table%normal)) contacts = size(table%normal, 2)
   end function count_places

   !> Add the force of a contact point to the record. Tension has no place in the centre of pressure
   pure subroutine add_force(table, joint, at, way, force, normal, press)
      type(place_table), intent(in) :: table
      integer, intent(in) :: joint                  !! row of its pair
      real(wp), intent(in) :: at(3)                 !! place of the point in the first body [m]
      real(wp), intent(in) :: way(3)                !! unit normal there
      real(wp), intent(in) :: force(3)              !! on the first body [N]
      real(wp), intent(in) :: normal                !! its part along the normal without dashpots, compression positive [N]
      real(wp), intent(inout) :: press(:, :)        !! (press_rows, contacts)
      integer :: k
      k = find_nearest(table, joint, at, way)
      if (k == 0) return
      press(1:3, k) = press(1:3, k) + force
      press(4, k) = press(4, k) + max(normal, 0.0_wp)
      press(5:7, k) = press(5:7, k) + max(normal, 0.0_wp) * at
   end subroutine add_force

   !> The contact of a pair to which a point belongs, 0 if none is recorded: least distance from its edges, and from its direction times
   !> its length, where contacts share an edge
   pure function find_nearest(table, joint, at, way) result(nearest)
      type(place_table), intent(in) :: table
      integer, intent(in) :: joint
      real(wp), intent(in) :: at(3)                 !! [m]
      real(wp), intent(in) :: way(3)
      integer :: nearest
      real(wp) :: least, distance, length
      integer :: k, i, j
      nearest = 0
      if (joint >= size(table%first)) return
      if (table%first(joint + 1) - table%first(joint) == 1) nearest = table%first(joint)
      if (nearest > 0) return
      least = huge(least)
      do k = table%first(joint), table%first(joint + 1) - 1
         distance = huge(distance)
         length = 0.0_wp
         do i = table%corner(k), table%corner(k + 1) - 1
            j = merge(table%corner(k), i + 1, i + 1 == table%corner(k + 1))
            distance = min(distance, find_distance(at, table%x(:, i), table%x(:, j)))
            length = max(length, norm2(table%x(:, j) - table%x(:, i)))
         end do
         distance = distance + length * (1.0_wp - abs(dot_product(way, table%normal(:, k))))
         if (distance < least) nearest = k
         least = min(least, distance)
      end do
   end function find_nearest

   !> Distance of a point from the line between two others [m]
   pure function find_distance(at, one, other) result(distance)
      real(wp), intent(in) :: at(3)                 !! [m]
      real(wp), intent(in) :: one(3)                !! [m]
      real(wp), intent(in) :: other(3)              !! [m]
      real(wp) :: distance
      real(wp) :: share
      share = dot_product(at - one, other - one) / max(sum((other - one)**2), tiny(1.0_wp))
      distance = norm2(at - one - max(0.0_wp, min(1.0_wp, share)) * (other - one))
   end function find_distance

end module dem_places
