!> Mechanisms of rigid parts: tables of their equation of motion, their places, their impact.
module api_mechanism
   use, intrinsic :: iso_c_binding, only : c_double, c_int
   implicit none
   private
   public :: table_length, tabulate, evaluate, follow, paths, path_length, restitution, blow

contains

   !> Length of the flat list of one side
   subroutine table_length(length)
      use mechanism_table, only : table_numbers
      integer(c_int), intent(out) :: length
      length = int(table_numbers, c_int)
   end subroutine table_length

   !> The table of a mechanism that rocks to one side
   subroutine tabulate(parts, hinges, rows, mass, centroid, inertia, joined, point, row, driver, sense, side, &
                       length, table, facts, status)
      use common_status, only : status_ok
      use mechanism_linkage, only : linkage, linkage_new, linkage_state
      use mechanism_table, only : side_table, table_facts, table_new, table_pack
      integer(c_int), intent(in) :: parts
      integer(c_int), intent(in) :: hinges
      integer(c_int), intent(in) :: rows
      real(c_double), intent(in) :: mass(parts)           !! [kg]
      real(c_double), intent(in) :: centroid(2, parts)    !! [m]
      real(c_double), intent(in) :: inertia(parts)        !! [kg m^2]
      integer(c_int), intent(in) :: joined(2, hinges)     !! parts that a hinge joins, 0 = ground
      real(c_double), intent(in) :: point(2, hinges)      !! [m]
      integer(c_int), intent(in) :: row(2, rows)          !! hinge and axis of the independent equations, 1-based
      integer(c_int), intent(in) :: driver                !! part whose rotation is q, 1-based
      integer(c_int), intent(in) :: sense                 !! +1: it turns counter-clockwise
      integer(c_int), intent(in) :: side                  !! +1: the structure rocks to +x
      integer(c_int), intent(in) :: length                !! see table_length
      real(c_double), intent(out) :: table(length)
      !> critical rotation, limit, lock [rad]; M [kg m^2], V' [N m], H [kg m] at rest; misfit and energy error
      real(c_double), intent(out) :: facts(8)
      integer(c_int), intent(out) :: status
      type(linkage) :: mechanism
      type(linkage_state) :: rest
      type(side_table) :: one_side
      type(table_facts) :: found
      !f2py threadsafe
      table = 0.0_c_double
      facts = 0.0_c_double
      call linkage_new(mass, centroid, inertia, joined, point, row, driver, real(sense, c_double), mechanism, rest, &
         status)
      if (status == status_ok) call table_new(mechanism, rest, int(side), one_side, found, status)
      facts = [one_side%critical, one_side%limit, found%lock, found%m, found%dv, found%dh, found%misfit, found%energy]
      if (status == status_ok) call table_pack(one_side, table)
   end subroutine tabulate

   !> M, M'/2, V', H and V of a table at nq rotations; `inside` is 0 past its end, and the numbers are zero there
   subroutine evaluate(length, nq, table, q, value, inside, status)
      use common_status, only : status_ok
      use mechanism_table, only : side_table, table_unpack
      integer(c_int), intent(in) :: length
      integer(c_int), intent(in) :: nq
      real(c_double), intent(in) :: table(length)
      real(c_double), intent(in) :: q(nq)            !! [rad]
      real(c_double), intent(out) :: value(5, nq)    !! [kg m^2], [kg m^2], [N m], [kg m], [J]
      integer(c_int), intent(out) :: inside(nq)
      integer(c_int), intent(out) :: status
      type(side_table) :: side
      logical :: closed
      integer :: k
      !f2py threadsafe
      value = 0.0_c_double
      inside = 0
      call table_unpack(table, side, status)
      if (status /= status_ok) return
      do k = 1, nq
         call side%coefficients(q(k), value(1, k), value(2, k), value(3, k), value(4, k), closed)
         if (.not. closed) cycle
         inside(k) = 1
         value(5, k) = side%potential(q(k))
      end do
   end subroutine evaluate

   !> Places of the parts and their first and second derivatives by q, at ascending q
   subroutine follow(parts, hinges, rows, mass, centroid, inertia, joined, point, row, driver, sense, &
                     nq, q, place, first, second, reached, status)
      use common_status, only : status_ok
      use mechanism_linkage, only : linkage, linkage_new, linkage_path, linkage_state
      integer(c_int), intent(in) :: parts
      integer(c_int), intent(in) :: hinges
      integer(c_int), intent(in) :: rows
      real(c_double), intent(in) :: mass(parts)
      real(c_double), intent(in) :: centroid(2, parts)
      real(c_double), intent(in) :: inertia(parts)
      integer(c_int), intent(in) :: joined(2, hinges)
      real(c_double), intent(in) :: point(2, hinges)
      integer(c_int), intent(in) :: row(2, rows)
      integer(c_int), intent(in) :: driver
      integer(c_int), intent(in) :: sense
      integer(c_int), intent(in) :: nq
      real(c_double), intent(in) :: q(nq)                  !! ascending [rad]
      real(c_double), intent(out) :: place(3, parts, nq)   !! centroid x, y [m], rotation [rad]
      real(c_double), intent(out) :: first(3, parts, nq)
      real(c_double), intent(out) :: second(3, parts, nq)
      integer(c_int), intent(out) :: reached               !! how many before the hinges part
      integer(c_int), intent(out) :: status
      type(linkage) :: mechanism
      type(linkage_state) :: rest
      !f2py threadsafe
      place = 0.0_c_double
      first = 0.0_c_double
      second = 0.0_c_double
      reached = 0
      call linkage_new(mass, centroid, inertia, joined, point, row, driver, real(sense, c_double), mechanism, rest, &
         status)
      if (status == status_ok) call linkage_path(mechanism, rest, q, place, first, second, reached, status)
   end subroutine follow

   !> Paths of points and parts as polynomials of q, see mechanism_path
   subroutine paths(parts, hinges, rows, part, joined, point, row, driver, sense, count, ends, place, reach, &
                    length, table, status)
      use common_status, only : status_ok, status_invalid_argument
      use mechanism_linkage, only : linkage, linkage_new, linkage_state
      use mechanism_path, only : path_new, path_numbers, path_pack, path_table
      integer(c_int), intent(in) :: parts
      integer(c_int), intent(in) :: hinges
      integer(c_int), intent(in) :: rows
      real(c_double), intent(in) :: part(4, parts)       !! mass [kg], centroid x, y [m], inertia [kg m^2]
      integer(c_int), intent(in) :: joined(2, hinges)
      real(c_double), intent(in) :: point(2, hinges)
      integer(c_int), intent(in) :: row(2, rows)
      integer(c_int), intent(in) :: driver
      integer(c_int), intent(in) :: sense
      integer(c_int), intent(in) :: count
      integer(c_int), intent(in) :: ends(3, count)       !! parts at both ends, 0 = ground; 1 length, 2 turn
      real(c_double), intent(in) :: place(2, 2, count)   !! [m]
      real(c_double), intent(in) :: reach(2)             !! greatest rotation, scale of the table of the mechanism [rad]
      integer(c_int), intent(in) :: length               !! see path_length
      real(c_double), intent(out) :: table(length)
      integer(c_int), intent(out) :: status
      type(linkage) :: mechanism
      type(linkage_state) :: rest
      type(path_table) :: found
      !f2py threadsafe
      table = 0.0_c_double
      status = status_invalid_argument
      if (length /= path_numbers(int(count))) return
      call linkage_new(part(1, :), part(2:3, :), part(4, :), joined, point, row, driver, real(sense, c_double), &
         mechanism, rest, status)
      if (status == status_ok) then
         call path_new(mechanism, rest, ends(3, :), ends(1:2, :), place, reach(1), reach(2), found, status)
      end if
      if (status == status_ok) call path_pack(found, table)
   end subroutine paths

   !> Length of the flat list of some paths
   subroutine path_length(count, length)
      use mechanism_path, only : path_numbers
      integer(c_int), intent(in) :: count
      integer(c_int), intent(out) :: length
      length = int(path_numbers(int(count)), c_int)
   end subroutine path_length

   !> c_v by workless impulses, see mechanism_impact
   subroutine restitution(n, mass, inertia, before, after, c_v)
      use mechanism_impact, only : projected_restitution
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: mass(n)       !! of the blocks [kg]
      real(c_double), intent(in) :: inertia(n)    !! about the centroids [kg m^2]
      real(c_double), intent(in) :: before(3, n)  !! velocity x, y, spin per unit rate of the mechanism that closes
      real(c_double), intent(in) :: after(3, n)   !! of the one that opens
      real(c_double), intent(out) :: c_v
      !f2py threadsafe
      c_v = projected_restitution(mass, inertia, before, after)
   end subroutine restitution

   !> Velocities after an inelastic impact at all joints, see mechanism_blow
   subroutine blow(n, joints, mass, inertia, centroid, side, ends, normal, tangent, before, after, status)
      use mechanism_blow, only : inelastic_blow
      integer(c_int), intent(in) :: n
      integer(c_int), intent(in) :: joints
      real(c_double), intent(in) :: mass(n)             !! of the blocks [kg]
      real(c_double), intent(in) :: inertia(n)          !! about the centroids [kg m^2]
      real(c_double), intent(in) :: centroid(2, n)      !! [m]
      integer(c_int), intent(in) :: side(2, joints)     !! blocks on both sides, 1 to n, 0 for the ground
      real(c_double), intent(in) :: ends(2, 2, joints)  !! [m]
      real(c_double), intent(in) :: normal(2, joints)
      real(c_double), intent(in) :: tangent(2, joints)
      real(c_double), intent(in) :: before(3, n)        !! velocity x, y, spin
      real(c_double), intent(out) :: after(3, n)
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call inelastic_blow(mass, inertia, centroid, side, ends, normal, tangent, before, after, status)
   end subroutine blow

end module api_mechanism
