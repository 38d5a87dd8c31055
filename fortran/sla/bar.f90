!> Bars with saw-tooth laws, and linear springs.
!>
!> The strain of a bar is given by the displacements of its nodes: two ends, or the corners of the elements in which its
!> ends, or it as a whole, are embedded. Ties bear no pressure, struts no tension: they go slack at zero stress and are
!> stretched again at zero strain (what has yielded unloads to its origin, as all that is damaged by teeth).
module sla_bar
   use common_kinds, only : wp
   use common_lists, only : code_tension => sla_event_tension, code_compression => sla_event_compression, &
      code_close => sla_event_close, code_open => sla_event_open
   use common_status, only : status_ok, status_out_of_memory, status_bad_geometry
   use sla_group, only : element_group, point_group, scan_result, event_vectors, material_options, unbounded, &
      admitted, linear_bound, most_entries
   use sla_tables, only : tooth_tables, tooth_tables_copy
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: bar_group, bar_group_new, spring_group, spring_group_new

   !> Strain that counts as small where a tie goes slack
   real(wp), parameter :: small = 1.0e-5_wp

   !> Bars; the damage of a bar is its tension and its compression tooth, and whether it is slack
   type, extends(point_group) :: bar_group
      real(wp), allocatable :: gradient(:, :)         !! (freedoms, elements) strain per displacement [1/m]
      real(wp), allocatable :: volume(:)              !! [m^3]
      real(wp), allocatable :: young(:)               !! [Pa]
      integer(c_int), allocatable :: table(:)
      integer(c_int), allocatable :: crush_table(:)
      real(wp), allocatable :: sense(:)               !! +1 bears tension alone, -1 pressure alone, 0 both
      integer(c_int), allocatable :: tooth(:, :)      !! (2, elements) tension, compression
      integer(c_int), allocatable :: taut(:)          !! 0: slack
      integer(c_int), allocatable :: changes(:)       !! times it went slack or was stretched again
      real(wp), allocatable :: modulus(:)             !! [Pa]
      type(tooth_tables) :: teeth
   contains
      procedure :: matrix => bar_matrix
      procedure :: force => bar_force
      procedure :: scan => bar_scan
      procedure :: damage => bar_damage
      procedure :: report => bar_report
      procedure :: state => bar_state
      procedure :: margin => bar_margin
      procedure :: is_elastic
   end type bar_group

   !> Springs between two freedoms, or one and the ground; they have no integration points
   type, extends(element_group) :: spring_group
      real(wp), allocatable :: stiffness(:)           !! [N/m]
   contains
      procedure :: matrix => spring_matrix
      procedure :: force => spring_force
   end type spring_group

contains

   !> Bars without damage
   subroutine bar_group_new(gradient, volume, young, table, crush_table, bears, teeth, options, group, bad, status)
      real(wp), intent(in) :: gradient(:, :, :)    !! (ways, nodes of a bar, elements) strain per displacement [1/m]
      real(wp), intent(in) :: volume(:)            !! [m^3]
      real(wp), intent(in) :: young(:)             !! [Pa]
      integer(c_int), intent(in) :: table(:)
      integer(c_int), intent(in) :: crush_table(:)
      integer(c_int), intent(in) :: bears(:)       !! 0 both, 1 tension alone, 2 pressure alone
      type(tooth_tables), intent(in) :: teeth
      type(material_options), intent(in) :: options
      type(bar_group), intent(out) :: group
      integer(c_int), intent(out) :: bad
      integer(c_int), intent(out) :: status
      integer :: e, i, n, ways, info

      n = size(gradient, 3)
      ways = size(gradient, 1)
      bad = 0
      status = status_out_of_memory
      group%elements = n
      group%points = n
      group%freedoms = ways * size(gradient, 2)
      group%directions = 1
      group%options = options
      call tooth_tables_copy(teeth, group%teeth, status)
      if (status /= status_ok) return
      status = status_out_of_memory
      allocate (group%gradient(group%freedoms, n), group%volume(n), group%young(n), group%table(n), &
         group%crush_table(n), group%sense(n), group%tooth(2, n), group%taut(n), group%changes(n), group%modulus(n), &
         stat=info)
      if (info /= 0) return
      do i = 1, size(gradient, 2)
         group%gradient(ways * (i - 1) + 1:ways * i, :) = gradient(:, i, :)
      end do
      group%volume(:) = volume
      group%young(:) = young
      group%modulus(:) = young
      group%table(:) = table
      group%crush_table(:) = crush_table
      group%sense(:) = merge(-1.0_wp, real(bears, wp), bears == 2)
      group%tooth = 1
      group%taut = 1
      group%changes = 0
      status = status_bad_geometry
      do e = 1, n
         bad = int(e, c_int)
         if (.not. (any(abs(gradient(:, :, e)) > 0.0_wp) .and. maxval(abs(gradient(:, :, e))) < unbounded .and. &
                    volume(e) > 0.0_wp)) return
      end do
      bad = 0
      status = status_ok
   end subroutine bar_group_new

   !> Strain of a bar
   pure function strain_of(group, e, u) result(strain)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: u(0:)
      real(wp) :: strain, local(most_entries)
      call group%gather(e, u, local)
      strain = dot_product(group%gradient(:, e), local(1:group%freedoms))
   end function strain_of

   pure subroutine bar_matrix(group, element, k)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: element
      real(wp), intent(out) :: k(:, :)
      integer :: i
      k = 0.0_wp
      do i = 1, group%freedoms
         k(1:group%freedoms, i) = group%volume(element) * group%modulus(element) * group%gradient(:, element) &
            * group%gradient(i, element)
      end do
   end subroutine bar_matrix

   pure subroutine bar_force(group, u, f)
      class(bar_group), intent(in) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: f(0:)
      real(wp) :: part
      integer :: e, i
      do e = 1, group%elements
         part = group%volume(e) * group%modulus(e) * strain_of(group, e, u)
         do i = 1, group%freedoms
            f(group%equation(i, e)) = f(group%equation(i, e)) + part * group%gradient(i, e) * group%factor(i, e)
         end do
      end do
   end subroutine bar_force

   !> Strengths in tension and compression [Pa]
   pure function bar_limits(group, e) result(limit)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: e
      real(wp) :: limit(2), tension, compression
      limit = unbounded
      if (group%taut(e) == 0) return
      tension = group%teeth%modulus_of(group%table(e), group%tooth(1, e), group%young(e), group%options%floor)
      compression = group%teeth%modulus_of(group%crush_table(e), group%tooth(2, e), group%young(e), group%options%floor)
      limit(1) = group%teeth%strength_of(group%table(e), group%tooth(1, e), group%modulus(e) / tension)
      limit(2) = group%teeth%strength_of(group%crush_table(e), group%tooth(2, e), group%modulus(e) / compression)
   end function bar_limits

   !> Does a bar have no limit at all?
   pure function is_free(group, e) result(yes)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: e
      logical :: yes
      yes = group%table(e) == 0 .and. group%crush_table(e) == 0 .and. .not. abs(group%sense(e)) > 0.0_wp
   end function is_free

   !> Are all bars without limits?
   pure function is_elastic(group) result(yes)
      class(bar_group), intent(in) :: group
      logical :: yes
      integer :: e
      yes = .true.
      do e = 1, group%elements
         yes = yes .and. is_free(group, e)
      end do
   end function is_elastic

   pure subroutine bar_scan(group, first, last, ua, ub, lambda, noise, found)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      type(scan_result), intent(inout) :: found
      real(wp) :: sa, sb, limit(2), gain, scale
      integer :: e
      do e = first, last
         if (is_free(group, e)) cycle
         sa = group%modulus(e) * strain_of(group, e, ua)
         sb = group%modulus(e) * strain_of(group, e, ub)
         limit = bar_limits(group, e)
         if (limit(1) < unbounded) then
           call linear_bound(sa, sb, limit(1), limit(1), lambda, noise, e, code_tension, found)
         end if
         if (limit(2) < unbounded) then
           call linear_bound(-sa, -sb, limit(2), limit(2), lambda, noise, e, code_compression, found)
         end if
         if (.not. abs(group%sense(e)) > 0.0_wp) cycle
         scale = small * group%young(e)
         if (group%taut(e) /= 0) then
            gain = -group%sense(e)
            call linear_bound(gain * sa, gain * sb, 0.0_wp, scale, lambda, noise, e, code_open, found)
         else if (group%changes(e) < group%options%most_changes) then
            ! Measured by the strain: the stress that a slack bar has left drowns in rounding
            gain = group%sense(e) * group%young(e) / group%modulus(e)
            call linear_bound(gain * sa, gain * sb, 0.0_wp, scale, lambda, noise, e, code_close, found)
         end if
      end do
   end subroutine bar_scan

   !> See point_group
   pure subroutine bar_margin(group, first, last, ua, ub, lambda, least)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: least(:)
      real(wp) :: stress, limit(2), share, ea, eb
      integer :: e, j
      do e = first, last
         if (is_free(group, e)) cycle
         ea = strain_of(group, e, ua)
         eb = strain_of(group, e, ub)
         share = sqrt(group%volume(e) / group%modulus(e))
         limit = bar_limits(group, e)
         do j = 1, size(lambda)
            stress = group%modulus(e) * (ea + lambda(j) * eb)
            if (limit(1) < unbounded) least(j) = min(least(j), share * (limit(1) - stress))
            if (limit(2) < unbounded) least(j) = min(least(j), share * (limit(2) + stress))
            if (abs(group%sense(e)) > 0.0_wp) least(j) = min(least(j), merge(share, -share, group%taut(e) /= 0) * &
               group%sense(e) * stress)
         end do
      end do
   end subroutine bar_margin

   pure subroutine bar_damage(group, point, code, lambda, ua, ub, event, tooth)
      class(bar_group), intent(inout) :: group
      integer, intent(in) :: point
      integer, intent(in) :: code
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      type(event_vectors), intent(out) :: event
      integer, intent(out) :: tooth
      real(wp) :: before, local(most_entries)
      integer :: k
      associate (unused_load => lambda, unused_a => ua, unused_b => ub)   ! a bar's axis is known beforehand
      end associate
      before = group%modulus(point)
      if (code == code_open .or. code == code_close) then
         group%taut(point) = merge(1_c_int, 0_c_int, code == code_close)
         group%changes(point) = group%changes(point) + 1_c_int
         tooth = int(group%changes(point))
      else
         k = merge(1, 2, code == code_tension)
         group%tooth(k, point) = group%tooth(k, point) + 1_c_int
         tooth = int(group%tooth(k, point))
      end if
      call bar_refresh(group, point)
      if (.not. abs(before - group%modulus(point)) > 0.0_wp) return
      event%rank = 1
      event%sign(1) = sign(1.0_wp, before - group%modulus(point))
      local(1:group%freedoms) = sqrt(group%volume(point) * abs(before - group%modulus(point))) &
         * group%gradient(:, point)
      call group%spread(point, local, event, 1)
   end subroutine bar_damage

   !> Modulus of a bar from its damage
   pure subroutine bar_refresh(group, e)
      class(bar_group), intent(inout) :: group
      integer, intent(in) :: e
      group%modulus(e) = min( &
         group%teeth%modulus_of(group%table(e), group%tooth(1, e), group%young(e), group%options%floor), &
         group%teeth%modulus_of(group%crush_table(e), group%tooth(2, e), group%young(e), group%options%floor))
      if (group%taut(e) == 0) group%modulus(e) = group%options%floor * group%young(e)
   end subroutine bar_refresh

   !> Rows as of a plane point: 4 tension tooth, 6 compression tooth, 8 taut, 10 changes
   pure subroutine bar_state(group, store, values)
      class(bar_group), intent(inout) :: group
      logical, intent(in) :: store
      real(wp), intent(inout) :: values(:, :)
      integer :: e
      if (store) then
         values = 0.0_wp
         values(4, :) = real(group%tooth(1, :), wp)
         values(6, :) = real(group%tooth(2, :), wp)
         values(8, :) = real(group%taut, wp)
         values(10, :) = real(group%changes, wp)
      else
         group%tooth(1, :) = nint(values(4, :), c_int)
         group%tooth(2, :) = nint(values(6, :), c_int)
         group%taut(:) = merge(min(nint(values(8, :), c_int), 1_c_int), 1_c_int, abs(group%sense) > 0.0_wp)
         group%changes(:) = nint(values(10, :), c_int)
         do e = 1, group%elements
            call bar_refresh(group, e)
         end do
      end if
   end subroutine bar_state

   !> Rows as of a plane point: the strain, the stress and the moduli of the bar's axis, 18 taut
   pure subroutine bar_report(group, ua, ub, lambda, noise, values)
      class(bar_group), intent(in) :: group
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      real(wp), intent(out) :: values(:, :)
      real(wp) :: axis(2), along
      type(scan_result) :: found
      integer :: e, k
      values = 0.0_wp
      k = 1 + group%freedoms / 2          ! in the plane and in space: of a node of the far end
      do e = 1, group%elements
         values(1, e) = strain_of(group, e, ua) + lambda * strain_of(group, e, ub)
         values(4, e) = group%modulus(e) * values(1, e)
         axis = group%gradient(k:k + 1, e)
         along = norm2(group%gradient(k:, e))
         if (along > 0.0_wp) values(7:8, e) = axis / along
         values(9, e) = group%modulus(e) / group%young(e)
         values(10, e) = 1.0_wp
         values(11, e) = real(group%tooth(1, e), wp)
         values(12, e) = 1.0_wp
         found = scan_result()
         call bar_scan(group, e, e, ua, ub, lambda, noise, found)
         values(13:14, e) = admitted(found)
         values(15, e) = group%volume(e)
         values(16, e) = real(group%tooth(2, e), wp)
         values(17, e) = 1.0_wp
         values(18, e) = real(group%taut(e), wp)
      end do
   end subroutine bar_report

   !> Springs between freedoms of the given equations
   subroutine spring_group_new(stiffness, group, status)
      real(wp), intent(in) :: stiffness(:)        !! [N/m]
      type(spring_group), intent(out) :: group
      integer(c_int), intent(out) :: status
      integer :: info
      group%elements = size(stiffness)
      group%freedoms = 2
      allocate (group%stiffness(size(stiffness)), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info == 0) group%stiffness(:) = stiffness
   end subroutine spring_group_new

   pure subroutine spring_matrix(group, element, k)
      class(spring_group), intent(in) :: group
      integer, intent(in) :: element
      real(wp), intent(out) :: k(:, :)
      k = 0.0_wp
      k(1:2, 1:2) = group%stiffness(element) * reshape([1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp], [2, 2])
   end subroutine spring_matrix

   pure subroutine spring_force(group, u, f)
      class(spring_group), intent(in) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: f(0:)
      real(wp) :: local(2), pull
      integer :: e
      do e = 1, group%elements
         call group%gather(e, u, local)
         pull = group%stiffness(e) * (local(1) - local(2))
         f(group%equation(1, e)) = f(group%equation(1, e)) + pull * group%factor(1, e)
         f(group%equation(2, e)) = f(group%equation(2, e)) - pull * group%factor(2, e)
      end do
   end subroutine spring_force

end module sla_bar
